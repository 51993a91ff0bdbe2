"""The planner's cost and its weighted mean, compiled."""

import ctypes
from typing import TypeGuard

import torch
from torch import Tensor

from faultpath.quadrotor.native.lending import is_exactly, lend
from faultpath.quadrotor.native.library import WIDEST, Kernels
from faultpath.quadrotor.planner import ScaledTemperature, Temperature
from faultpath.quadrotor.planner.costs import NavigationCost, RunningGoal, Scored, TerminalGoal
from faultpath.quadrotor.vehicle import COLLISION_RADIUS_M

_TERMS = ("goal", "risk", "hit", "margin", "radius", "speed", "v_max", "heading")
_EFFORTS = ("rate_effort", "thrust_effort")


class _Weights(ctypes.Structure):
    """`Weights` of `costs.cpp`."""

    _fields_ = (
        ("running", ctypes.c_int64),
        *((name, ctypes.c_float) for name in _TERMS + _EFFORTS),
    )


class CompiledCost(NavigationCost):
    """The navigation cost in one pass over the candidates.

    Raises `ValueError` where a tensor is not what the kernel takes; see `lend`.
    """

    def __init__(self, kernels: Kernels, cost: NavigationCost) -> None:
        super().__init__(cost.goal, cost.weights)
        self._kernels = kernels
        w = cost.weights
        self._table = _Weights(
            running=isinstance(cost.goal, RunningGoal),
            **{name: getattr(w, name) for name in ("goal", "risk", "hit", "speed", "heading")},
            **{name: getattr(w, name) for name in _EFFORTS},
            margin=w.margin_m,
            v_max=w.v_max_mps,
            radius=COLLISION_RADIUS_M,
        )

    @staticmethod
    def covers(cost: object) -> TypeGuard[NavigationCost]:
        """Return whether `cost` is one that this can stand for."""
        if not is_exactly(cost, NavigationCost):
            return False
        return is_exactly(cost.goal, TerminalGoal) or is_exactly(cost.goal, RunningGoal)

    def __call__(self, scored: Scored) -> Tensor:
        """See `NavigationCost`."""
        rollout, commands = scored.rollout, scored.commands
        steps, _, scenes, candidates = commands.shape
        if candidates % WIDEST or not steps:
            return super().__call__(scored)
        costs = commands.new_empty(scenes, candidates)
        moved = (3, scenes, steps, candidates)
        self._kernels.call(
            "faultpath_cost",
            ctypes.byref(self._table),
            lend("positions", rollout.positions.contiguous(), *moved),
            lend("velocities", rollout.velocities.contiguous(), *moved),
            lend("rotation", rollout.final.rotation.contiguous(), 3, 3, scenes, candidates),
            lend("commands", commands.contiguous(), steps, 4, scenes, candidates),
            lend("clearance", scored.clearance.contiguous(), scenes, steps, candidates),
            lend("goal", scored.goal.contiguous(), 3, scenes),
            lend("hover", scored.hover.contiguous(), scenes),
            *(steps, scenes, candidates),
            lend("costs", costs, scenes, candidates),
        )
        return costs


class CompiledTemperature(Temperature):
    """The scaled temperature and its softmax without a full sort."""

    def __init__(self, kernels: Kernels, temperature: ScaledTemperature) -> None:
        self._kernels = kernels
        self._portable = temperature
        self._scale = torch.tensor([temperature.fraction, temperature.least])

    @staticmethod
    def covers(temperature: object) -> TypeGuard[ScaledTemperature]:
        """Return whether `temperature` is one that this can stand for."""
        return is_exactly(temperature, ScaledTemperature)

    def of(self, cost: Tensor) -> Tensor:
        """See `Temperature.of`."""
        return self._portable.of(cost)

    def weights(self, cost: Tensor) -> Tensor:
        """See `Temperature.weights`."""
        scenes, candidates = cost.shape
        if candidates % WIDEST or not candidates:
            return super().weights(cost)
        weights = torch.empty_like(cost)
        scratch = cost.new_empty(candidates)
        self._kernels.call(
            "faultpath_weights",
            lend("cost", cost, scenes, candidates),
            lend("scale", self._scale, 2),
            *(scenes, candidates),
            lend("scratch", scratch, candidates),
            lend("weights", weights, scenes, candidates),
        )
        return weights


class CompiledMean:
    """The mean of candidates under weights."""

    def __init__(self, kernels: Kernels) -> None:
        self._kernels = kernels

    def __call__(self, commands: Tensor, weight: Tensor) -> Tensor:
        """See `planner.mppi.weighted_mean`."""
        steps, channels, scenes, candidates = commands.shape
        if candidates % WIDEST:
            return (commands * weight).sum(-1)
        plan = commands.new_empty(steps, channels, scenes)
        self._kernels.call(
            "faultpath_mean",
            lend("commands", commands.contiguous(), *commands.shape),
            lend("weight", weight.contiguous(), scenes, candidates),
            *(steps * channels, scenes, candidates),
            lend("plan", plan, steps, channels, scenes),
        )
        return plan
