"""Which channel enters a predictor at which place, and where it goes there: the one such map.

Flights, training and probes all build what a predictor is told here; they differ only in where a
delivered value comes from.
"""

from collections.abc import Callable, Collection

import torch
from torch import Tensor

from faultpath.core.errors import SystemMistake
from faultpath.loop import Inputs, Port
from faultpath_quadrotor import so3
from faultpath_quadrotor.device import host_readable
from faultpath_quadrotor.lanes import lanes_last
from faultpath_quadrotor.predictors.base import Calibration, History, Physics, PredictorInputs
from faultpath_quadrotor.state import State

STATE = ("position", "velocity", "attitude", "body_rate")

PLACES: dict[str, tuple[str, ...]] = {
    "initial_state": STATE,
    "trim": ("mass", "thrust_scale"),
    "dynamics": ("mass", "thrust_scale"),
    "features": ("mass", "thrust_scale"),
    "normalise_thrust": ("mass",),
    "wind_map": ("mass", "wind"),
    "physics": ("physics",),
    "latent": ("history_code",),
    "history": ("velocity", "attitude", "body_rate", "action", "mass"),
}
"""The channels that enter at each place."""

Take = Callable[[str, str], Tensor]
"""`take(channel, place)`: what a tap delivered, lanes last, single precision."""


def taking(inputs: Inputs, lanes: Tensor) -> Take:
    """Return what gives a predictor the readings of a step, lanes last, single precision."""

    def take(channel: str, place: str) -> Tensor:
        return lanes_last(inputs[Port(channel, place)], lanes).float()

    return take


def ports(places: Collection[str]) -> frozenset[Port]:
    """Return the ports of some places."""
    return frozenset(Port(channel, place) for place in places for channel in PLACES[place])


def check_places(name: str, places: Collection[str]) -> None:
    """Raise `SystemMistake` for a user's predictor that reads at no such places together."""
    for place in places:
        if place not in PLACES:
            known = "; ".join(f"{at} ({', '.join(channels)})" for at, channels in PLACES.items())
            raise SystemMistake(
                f"{name} reads at the place {place!r}, which predictors do not have: "
                f"choose from {known}"
            )
    if absent := [needed for needed in ("initial_state", "trim") if needed not in places]:
        raise SystemMistake(
            f"{name} does not read at {absent[0]!r}, which every predictor does: add it to reads"
        )
    if ("history" in places) != ("latent" in places):
        raise SystemMistake(
            f"{name} reads at one of 'history' and 'latent': name both, for the first feeds "
            "encode(), and what that returns arrives at the second"
        )


def calibration(take: Take, place: str) -> Calibration:
    """Return the mass and the thrust scale of a place."""
    return Calibration(take("mass", place), take("thrust_scale", place))


def predictor_inputs(reads: Collection[str], take: Take) -> PredictorInputs:
    """Return what a predictor that reads at these places is told, batch `[*lanes, 1]`.

    `take` gives `[..., *lanes]`; of the places in `reads`, only that of the history is not asked.
    """

    def column(channel: str, place: str) -> Tensor:
        return take(channel, place)[..., None]

    def calibrated(place: str) -> Calibration | None:
        return calibration(column, place) if place in reads else None

    return PredictorInputs(
        state=_start(State(*(take(name, "initial_state") for name in STATE))),
        trim=calibration(column, "trim"),
        dynamics=calibrated("dynamics"),
        wind_map_mass_kg=column("mass", "wind_map") if "wind_map" in reads else None,
        wind_mps=column("wind", "wind_map") if "wind_map" in reads else None,
        physics=Physics.of(column("physics", "physics")) if "physics" in reads else None,
        thrust_mass_kg=(
            column("mass", "normalise_thrust") if "normalise_thrust" in reads else None
        ),
        conditioning=calibrated("features"),
        code=column("history_code", "latent") if "latent" in reads else None,
    )


def history(reads: Collection[str], take: Take) -> History:
    """Return the history that a predictor is told, batch `[*lanes]`.

    `take` gives motion and commands with their intervals before the lanes, `[..., T, *lanes]`.
    """
    return History(
        velocity_mps=take("velocity", "history"),
        rotation=take("attitude", "history"),
        rate_radps=take("body_rate", "history"),
        commands=take("action", "history"),
        mass_kg=take("mass", "history"),
        conditioning=calibration(take, "features") if "features" in reads else None,
    )


def _start(state: State) -> State:
    """Return the state with a candidate axis, and with attitudes that are rotations.

    A fault may have added noise to the attitude; a reading that is a rotation already comes out
    of the projection changed by rounding only, so it is left alone.
    """
    rotation = state.rotation
    off = so3.compose(rotation.transpose(0, 1), rotation)
    off = (off - torch.eye(3, device=off.device).view(3, 3, *(1 for _ in state.batch))).abs().amax(
        (0, 1)
    ) > 1e-4
    if not host_readable(off.device) or off.any():
        rotation = torch.where(off, so3.project(rotation), rotation)
    parts = (state.position, state.velocity, rotation, state.rate)
    return State(*(part[..., None] for part in parts))
