"""WM-U: a learned predictor without the kinematic integrator."""

from dataclasses import dataclass, replace

import torch
from torch import Tensor
from typing_extensions import override

from faultpath_quadrotor import so3
from faultpath_quadrotor.batching import Delivered
from faultpath_quadrotor.predictors.base import Memory, Predictor, PredictorInputs
from faultpath_quadrotor.predictors.network import FoldedNetwork, LatentNetwork
from faultpath_quadrotor.state import State

HIDDEN = 128  # paper, Section IV-A
OUTPUTS = 12


class UnanchoredNetwork(LatentNetwork):
    """The network of WM-U: its outputs are increments in units of the training pool's spread."""

    increment_std: Tensor

    def __init__(self) -> None:
        super().__init__(HIDDEN, OUTPUTS, conditioning=2)
        self.register_buffer("increment_std", torch.ones(OUTPUTS, 1))


@dataclass(frozen=True)
class _Memory:
    network: FoldedNetwork
    latent: Tensor
    mass_kg: Tensor
    conditioning: tuple[Tensor, Tensor]


class UnanchoredPredictor(Predictor):
    """Increments of position, velocity, body rate and attitude come straight from a network (WM-U).

    The rotation increment is composed with the present attitude, so that attitudes stay rotations.
    The supplied calibration enters by the thrust's normalisation and as two features; there is no
    analytic branch, and no wind input (paper, Section IV-A).
    """

    reads = frozenset(
        {"initial_state", "trim", "normalise_thrust", "history", "features", "latent"}
    )

    def __init__(self, network: UnanchoredNetwork) -> None:
        self.network = network

    @override
    def encode(self, history: Delivered) -> Tensor:
        return self.network.encode(history)

    def begin(self, inputs: PredictorInputs) -> Memory:
        """Start every candidate with the history code."""
        return _Memory(
            self.network.fold(),
            inputs["history_code", "latent"],
            inputs["mass", "normalise_thrust"],
            (inputs["mass", "features"], inputs["thrust_scale", "features"]),
        )

    def step(self, state: State, command: Tensor, memory: _Memory) -> tuple[State, Memory]:
        """Advance one interval; see `Predictor.step`."""
        latent, outputs = memory.network.roll(
            memory.latent, state, command, memory.mass_kg, memory.conditioning
        )
        scale = self.network.increment_std.reshape(-1, *(1,) * (outputs.ndim - 1))
        moved, pushed, spun, turned = (outputs * scale).split(3)
        ahead = State(
            state.position + moved,
            state.velocity + pushed,
            so3.compose(state.rotation, so3.exp(turned)),
            state.rate + spun,
        )
        return ahead, replace(memory, latent=latent)
