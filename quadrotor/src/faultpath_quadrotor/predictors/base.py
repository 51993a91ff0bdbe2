"""Predictors as the planner, training and probes use them: where they read, and what they get."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any

import torch
from torch import Tensor

from faultpath.loop import Port
from faultpath.plugin.system import SystemMistake
from faultpath_quadrotor import so3
from faultpath_quadrotor.batching import Delivered, Read
from faultpath_quadrotor.device import host_readable
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import GRAVITY_MPS2

Memory = Any
"""State that a predictor carries from step to step; opaque to everybody else."""


@dataclass(frozen=True)
class Physics:
    """Physical parameters that only the true-parameter predictor may read, all `[.., *batch]`."""

    inertia_kgm2: Tensor
    torque_scale: Tensor
    motor_time_constant_s: Tensor
    drag_kgps: Tensor
    collective_thrust_n: Tensor
    """Thrust that the motors hold at this moment, before the thrust scale, N."""

    @classmethod
    def of(cls, reading: Tensor) -> "Physics":
        """Return the parameters in a reading `[9, *batch]` of the channel `physics`."""
        return cls(reading[0:3], reading[3], reading[4], reading[5:8], reading[8])

    def reading(self) -> Tensor:
        """Return them as the channel `physics` carries them, `[9, *batch]`."""
        torque, lag, thrust = (
            part[None]
            for part in (self.torque_scale, self.motor_time_constant_s, self.collective_thrust_n)
        )
        return torch.cat((self.inertia_kgm2, torque, lag, self.drag_kgps, thrust))


@dataclass(frozen=True)
class PredictorInputs:
    """Everything a predictor reads at a replan, as its taps delivered it; batch `[S, 1]`."""

    state: State
    """State at `initial_state`; its attitudes are rotations."""
    delivered: Delivered
    """Readings by channel and place, at the other places where the predictor reads now."""

    def __getitem__(self, read: Read) -> Tensor:
        """Return what a tap delivered; `SystemMistake` where the predictor does not read."""
        if read not in self.delivered:
            channel, place = read
            raise SystemMistake(
                f"the predictor asks for {channel} at {place!r} and does not read there: add "
                f"{place!r} to its reads"
            )
        return self.delivered[read]

    @property
    def hover_thrust(self) -> Tensor:
        """Collective thrust that holds the vehicle if the calibration is right, N, `[S]`."""
        return (self["mass", "trim"] * GRAVITY_MPS2 / self["thrust_scale", "trim"])[:, 0]

    def take(self, scenes: Sequence[int] | Tensor) -> "PredictorInputs":
        """Return the inputs of some scenes, in the order given."""
        index = torch.as_tensor(scenes)
        return PredictorInputs(
            self.state.map(lambda part: part.index_select(-2, index)),
            {read: value.index_select(-2, index) for read, value in self.delivered.items()},
        )


@dataclass(frozen=True)
class Rollout:
    """Predicted motion under candidate commands; `h = 0` is the end of the first interval."""

    positions: Tensor
    """`[3, S, H, K]`, metres, world frame: each scene's points lie together for the clearance."""
    velocities: Tensor
    """`[3, S, H, K]`, m/s, world frame."""
    final: State
    """State at the end of the horizon, batch `[S, K]`."""


class Predictor(ABC):
    """Rolls candidate commands forward at the control rate.

    `begin` is called once a replan, `step` once a horizon step. Batches are `[S, K]`: scenes and
    candidates.
    """

    reads: frozenset[str]
    """Places at which it reads its channels: its readers in the interface."""
    data_files: Sequence[str | PathLike[str]] | None = None
    """Files that a user's own predictor reads, of every seed, such as weights."""

    def encode(self, history: Delivered) -> Tensor | None:
        """Return the history code `[32, *batch]`, once a replan; `None` without a memory.

        `history` holds the last intervals, oldest first, as the taps of the places `history` and
        `features` delivered them: motion in the world frame at the start of each, velocity
        `[3, T, *batch]` in m/s, attitude `[3, 3, T, *batch]`, body rate `[3, T, *batch]` in rad/s;
        the action executed over each, `[4, T, *batch]` in N and rad/s; calibration `[*batch]`.
        """
        del history
        return None

    @abstractmethod
    def begin(self, inputs: PredictorInputs) -> Memory:
        """Prepare what stays the same over the horizon and the initial memory."""

    @abstractmethod
    def step(self, state: State, command: Tensor, memory: Memory) -> tuple[State, Memory]:
        """Advance one control interval under `command` `[4, S, K]`."""


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
"""`take(channel, place)`: what a tap delivered, lanes last."""


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
    readings = delivered([place for place in reads if place != "history"], take)
    state = State(*(readings.pop((channel, "initial_state")) for channel in STATE))
    known = {read: value[..., None] for read, value in readings.items()}
    return PredictorInputs(_start(state), known)


def history(reads: Collection[str], take: Take) -> Delivered:
    """Return the history that a predictor reads, batch `[*lanes]`.

    `take` gives motion and commands with their intervals before the lanes, `[..., T, *lanes]`.
    """
    return delivered({"history", "features"}.intersection(reads), take)


def delivered(places: Collection[str], take: Take) -> dict[Read, Tensor]:
    """Return what the taps of some places delivered, in single precision."""
    return {
        (channel, place): take(channel, place).float()
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
