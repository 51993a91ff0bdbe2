"""WM-A: the kinematic integrator with learned residual accelerations inside it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from torch import Tensor
from typing_extensions import override

from faultpath_quadrotor.batching import Delivered
from faultpath_quadrotor.predictors.base import Memory, Predictor, PredictorInputs
from faultpath_quadrotor.predictors.kinematic import Constants, KinematicIntegrator, Residual
from faultpath_quadrotor.predictors.network import FoldedNetwork, LatentNetwork
from faultpath_quadrotor.state import State

HIDDEN = 64  # paper, Section IV-A
LINEAR_BOUND_MPS2 = 8.0
"""Bound of the linear residual: more than the strongest drag and wind of the pools ask for at the
vehicle's median mass, less than gravity (derived)."""
ANGULAR_BOUND_RADPS2 = 40.0
"""Bound of the angular residual: two thirds of what the nominal rate loop gives for an error of
3 rad/s (derived)."""


@dataclass(frozen=True)
class _Memory:
    network: FoldedNetwork
    latent: Tensor
    constants: Constants
    mass_kg: Tensor


class AnchoredPredictor(Predictor):
    """Bounded residual accelerations from a recurrent network enter the DKI update (WM-A).

    The supplied calibration enters twice: m~ normalises thrust in the features, and (m~, T~) drive
    the integrator. With `wind` the integrator also has its wind term; the network never sees the
    wind (paper, Section IV-A).
    """

    def __init__(
        self, network: LatentNetwork, wind: bool, drag_kgps: Sequence[float] | None = None
    ) -> None:
        self.network = network
        self.kinematics = KinematicIntegrator(wind=wind, drag_kgps=drag_kgps)
        self.reads = self.kinematics.reads | {"normalise_thrust", "history", "latent"}

    @staticmethod
    def build_network() -> LatentNetwork:
        """Return a network of the right shape."""
        return LatentNetwork(HIDDEN, outputs=6)

    @override
    def encode(self, history: Delivered) -> Tensor:
        return self.network.encode(history)

    def begin(self, inputs: PredictorInputs) -> Memory:
        """Start every candidate with the history code."""
        return _Memory(
            self.network.fold(),
            inputs["history_code", "latent"],
            self.kinematics.begin(inputs),
            inputs["mass", "normalise_thrust"],
        )

    def step(self, state: State, command: Tensor, memory: _Memory) -> tuple[State, Memory]:
        """Advance one interval; see `Predictor.step`."""
        latent, outputs = memory.network.roll(memory.latent, state, command, memory.mass_kg)
        bounded = outputs.tanh()
        residual = Residual(bounded[:3] * LINEAR_BOUND_MPS2, bounded[3:] * ANGULAR_BOUND_RADPS2)
        ahead = self.kinematics.advance(state, command, memory.constants, residual)
        return ahead, replace(memory, latent=latent)
