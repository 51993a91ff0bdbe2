"""Which channel enters a predictor at which place: the one such map.

Flights, training and probes all build a predictor's inputs here; they differ only in where a
delivered value comes from.
"""

from collections.abc import Callable, Collection
from dataclasses import replace

import torch
from torch import Tensor

from faultpath.loop import Port
from faultpath.plugin.system import SystemMistake
from faultpath_quadrotor import so3
from faultpath_quadrotor.batching import Delivered
from faultpath_quadrotor.device import host_readable
from faultpath_quadrotor.predictors.base import PredictorInputs
from faultpath_quadrotor.state import State

STATE = ("position", "velocity", "attitude", "body_rate")

PLACES: dict[str, tuple[str, ...]] = {
    "initial_state": STATE,
    "trim": ("mass", "thrust_scale"),
    "dynamics": ("mass", "thrust_scale"),
    "wind_map": ("mass", "wind"),
    "physics": ("physics",),
    "normalise_thrust": ("mass",),
    "features": ("mass", "thrust_scale"),
    "latent": ("history_code",),
    "history": ("velocity", "attitude", "body_rate", "action", "mass"),
}
"""The channels that enter at each place."""

Take = Callable[[str, str], Tensor]
"""`take(channel, place)`: what a tap delivered, lanes last, single precision."""


def single(readings: Delivered) -> Take:
    """Return the function that takes readings in single precision."""
    return lambda channel, place: readings[channel, place].float()


def ports(places: Collection[str]) -> frozenset[Port]:
    """Return the ports of some places."""
    return frozenset(Port(channel, place) for place in places for channel in PLACES[place])


def check_places(name: str, places: Collection[str]) -> None:
    """Raise `SystemMistake` for a user's predictor whose places do not exist or go together."""
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


def predictor_inputs(reads: Collection[str], take: Take) -> PredictorInputs:
    """Return the inputs of a predictor that reads at these places, batch `[*lanes, 1]`.

    `take` gives `[..., *lanes]`; it is called for all places in `reads` but `history`.
    """
    state = _start(State(*(take(channel, "initial_state") for channel in STATE)))
    places = [place for place in reads if place not in ("initial_state", "history")]
    known = {read: value[..., None] for read, value in delivered(places, take).items()}
    return PredictorInputs(state, known)


def history(reads: Collection[str], take: Take) -> Delivered:
    """Return the history that a predictor reads, batch `[*lanes]`.

    `take` gives motion and commands with their intervals before the lanes, `[..., T, *lanes]`.
    """
    return delivered({"history", "features"}.intersection(reads), take)


def delivered(places: Collection[str], take: Take) -> Delivered:
    """Return what the taps of some places delivered."""
    return {
        (channel, place): take(channel, place)
        for place, channels in PLACES.items()
        if place in places
        for channel in channels
    }


def _start(state: State) -> State:
    """Return the state with a candidate axis, and with attitudes that are rotations.

    A fault may have added noise to the attitude; a reading that is a rotation already comes out
    of the projection changed by rounding only, so it is left alone.
    """
    rotation = state.rotation
    product = so3.compose(rotation.transpose(0, 1), rotation)
    identity = torch.eye(3, device=product.device).view(3, 3, *(1 for _ in state.batch))
    off = (product - identity).abs().amax((0, 1)) > 1e-4
    if not host_readable(off.device) or off.any():
        rotation = torch.where(off, so3.project(rotation), rotation)
    return replace(state, rotation=rotation).map(lambda part: part[..., None])
