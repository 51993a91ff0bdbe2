"""Parts as a user would bring them: what the tests of bringing share."""

import torch
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.planners import MPPI, AutoregressiveSampler, CostWeights, NavigationCost
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.predictors import KinematicIntegrator
from faultpath_quadrotor.reconstruction import Reconstruction
from torch import Tensor

OPTIONS = QuadrotorOptions()


class Heavy(KinematicIntegrator):
    """Kinematics that a compiled kernel does not stand for."""

    def __init__(self, seed: int | None) -> None:
        super().__init__(drag=True, drag_kgps=PLATFORM.drag_kgps)
        self.seed = seed


class K(KinematicIntegrator):
    """Kinematics in the wind of the platform that is flown."""

    def __init__(self, drag: bool = False, wind: bool = True) -> None:
        super().__init__(drag, wind, drag_kgps=PLATFORM.drag_kgps)


class Constant(Reconstruction):
    """Wind from nowhere."""

    reads = frozenset({("mass", "wind_map")})

    def begin(self, delivered: dict[tuple[str, str], Tensor]) -> Tensor:
        return delivered["mass", "wind_map"]

    def update(self, memory: Tensor, delivered: dict[tuple[str, str], Tensor]) -> Tensor:
        return delivered["mass", "wind_map"]

    def wind(self, memory: Tensor) -> Tensor:
        return torch.stack([2 * memory, memory, 0 * memory])


class Halved(MPPI):
    """MPPI that goes half of its way."""

    def update(self, search, scored):
        return super().update(search, scored)


def blind(seed) -> KinematicIntegrator:
    return K(drag=False, wind=False)


def predictor(seed) -> KinematicIntegrator:
    return Heavy(seed)


def exact(seed) -> KinematicIntegrator:
    return KinematicIntegrator(drag=True, drag_kgps=PLATFORM.drag_kgps)


def wind(seed) -> Constant:
    return Constant()


def planner(seed) -> Halved:
    sampler, cost = AutoregressiveSampler(OPTIONS.sampling), CostWeights(running=0.0)
    return Halved(sampler, NavigationCost(cost), PLATFORM.planner.temperature)
