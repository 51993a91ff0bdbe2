"""The horizon loop, compiled: all steps of a predictor for one tile of candidates at a time."""

import ctypes
import math

import torch
from torch import Tensor

from faultpath.quadrotor.native.coverage import uncovered
from faultpath.quadrotor.native.lending import Lent, lend
from faultpath.quadrotor.native.library import Kernels
from faultpath.quadrotor.native.packing import BLOCK, pack
from faultpath.quadrotor.predictors import (
    AnchoredPredictor,
    KinematicIntegrator,
    LatentNetwork,
    Predictor,
    PredictorInputs,
    UnanchoredPredictor,
)
from faultpath.quadrotor.predictors.anchored import ANGULAR_BOUND_RADPS2, LINEAR_BOUND_MPS2
from faultpath.quadrotor.predictors.network import ACTION_EMBEDDING, LATENT, FoldedNetwork
from faultpath.quadrotor.predictors.unanchored import OUTPUTS, UnanchoredNetwork
from faultpath.quadrotor.rollout import Rollout
from faultpath.quadrotor.state import State
from faultpath.quadrotor.vehicle import GRAVITY_MPS2

_LOG2_E = 1 / math.log(2)
"""The kernel takes powers of two: scales of the unit's logistic functions go into its weights."""

_KINEMATIC, _ANCHORED, _UNANCHORED = range(3)
_LAYERS = ("embed", "gates", "candidate", "remembered", "first", "second", "last")


class _Layer(ctypes.Structure):
    _fields_ = (
        ("weights", ctypes.c_void_p),
        ("inputs", ctypes.c_int64),
        ("outputs", ctypes.c_int64),
    )


class _Model(ctypes.Structure):
    """`Predictor` of `rollout.cpp`."""

    _fields_ = (
        ("kind", ctypes.c_int64),
        ("windy", ctypes.c_int64),
        ("dragging", ctypes.c_int64),
        *((name, _Layer) for name in _LAYERS),
        *((name, ctypes.c_float) for name in ("dt", "keep", "mean", "gravity")),
        ("linear_bound", ctypes.c_float),
        ("angular_bound", ctypes.c_float),
        ("drag", ctypes.c_float * 3),
        ("spread", ctypes.c_float * OUTPUTS),
    )


class _Inputs(ctypes.Structure):
    """`Inputs` of `rollout.cpp`."""

    _fields_ = tuple(
        (name, ctypes.c_void_p)
        for name in (
            *("position", "velocity", "rotation", "rate", "mass", "thrust_scale", "wind"),
            *("wind_mass", "thrust_mass", "shown_mass", "shown_scale", "code"),
        )
    )


class CompiledRollout:
    """Rolls candidates of one predictor out, with the weights that it has when this is made."""

    def __init__(self, kernels: Kernels, predictor: Predictor) -> None:
        """Copy the predictor's weights; raises `ValueError` where `uncovered` has a reason."""
        if why := uncovered(predictor):
            raise ValueError(f"no compiled rollout of {type(predictor).__name__}: {why}")
        self._kernels = kernels
        self._kept: list[Lent] = []  # the kernel holds addresses only
        self._model = _Model(gravity=GRAVITY_MPS2)
        self._reads = predictor.reads
        if isinstance(predictor, UnanchoredPredictor):
            self._model.kind = _UNANCHORED
            self._set_network(predictor.network)
        elif isinstance(predictor, AnchoredPredictor):
            self._model.kind = _ANCHORED
            self._set_network(predictor.network)
            self._set_kinematics(predictor.kinematics)
        elif isinstance(predictor, KinematicIntegrator):
            self._model.kind = _KINEMATIC
            self._set_kinematics(predictor)

    def __call__(self, inputs: PredictorInputs, commands: Tensor) -> Rollout:
        """Roll `commands` `[H, 4, S, K]` out from `inputs`, whose batch is `[S, 1]`.

        Raises:
            ValueError: There is no step, the predictor was not told what it reads, or a tensor is
                not what the kernel takes; see `lend`.
        """
        horizon, _, scenes, candidates = commands.shape
        if not horizon:
            raise ValueError("there is no step to roll out: the commands have a horizon of 0")
        positions = commands.new_empty(3, scenes, horizon, candidates)
        velocities = torch.empty_like(positions)
        ends = commands.new_empty(12, scenes, candidates)
        told = _told(inputs, self._reads, scenes)
        self._kernels.call(
            "faultpath_roll",
            ctypes.byref(self._model),
            ctypes.byref(_Inputs(*(part if part is None else part.address for part in told))),
            lend("commands", commands.contiguous(), horizon, 4, scenes, candidates),
            *(horizon, scenes, candidates),
            lend("positions", positions, 3, scenes, horizon, candidates),
            lend("velocities", velocities, 3, scenes, horizon, candidates),
            lend("ends", ends, 12, scenes, candidates),
        )
        rotation = ends[:9].unflatten(0, (3, 3))
        final = State(positions[:, :, -1], velocities[:, :, -1], rotation, ends[9:])
        return Rollout(positions, velocities, final)

    def _set_kinematics(self, integrator: KinematicIntegrator) -> None:
        self._model.windy = "wind_map" in integrator.reads
        self._model.dragging = integrator.drag
        self._model.dt, self._model.keep, self._model.mean = integrator.step_constants
        self._model.drag[:] = integrator.air.coefficients_kgps
        self._model.linear_bound = LINEAR_BOUND_MPS2
        self._model.angular_bound = ANGULAR_BOUND_RADPS2

    @torch.no_grad()
    def _set_network(self, network: LatentNetwork) -> None:
        for name, (weights, block) in _layers(network.fold()).items():
            packed = pack(weights, block)
            lent = lend(name, packed, *packed.shape)
            self._kept.append(lent)
            outputs = packed.shape[0] * block
            setattr(self._model, name, _Layer(lent.address, packed.shape[1] - 1, outputs))
        if isinstance(network, UnanchoredNetwork):
            self._model.spread[:] = network.increment_std.flatten().tolist()


def _layers(folded: FoldedNetwork) -> dict[str, tuple[Tensor, int]]:
    """Return each layer as (bias, weights) columns without the rows that pass a one on."""
    split = ACTION_EMBEDDING
    gates, whole = folded.gates, (folded.first, folded.second)
    first, second = (_bias_first(layer[:-1]) for layer in whole)
    gates = torch.cat((gates[:, split : split + 1], gates[:, :split], gates[:, split + 1 :]), 1)
    return {
        "embed": (_bias_first(folded.embed[:-1]), BLOCK),
        "gates": (gates * -_LOG2_E, BLOCK),
        "candidate": (_bias_first(folded.candidate) * (-2 * _LOG2_E), BLOCK),
        "remembered": (folded.remembered * (-2 * _LOG2_E), BLOCK),
        "first": (first, BLOCK),
        "second": (second, BLOCK),
        "last": (_bias_first(folded.last), BLOCK),
    }


def _bias_first(weights: Tensor) -> Tensor:
    return weights.roll(1, dims=1)


def _told(inputs: PredictorInputs, reads: frozenset[str], scenes: int) -> tuple[Lent | None, ...]:
    """Return the tensors of `Inputs` of `rollout.cpp`, each `[rows, S]` in memory.

    What the predictor does not read is left out; `ValueError` where it is told less than it reads.
    """
    state, dynamics, shown = inputs.state, inputs.dynamics, inputs.conditioning
    told: tuple[tuple[str, str, Tensor | None, tuple[int, ...]], ...] = (
        ("position", "", state.position, (3,)),
        ("velocity", "", state.velocity, (3,)),
        ("rotation", "", state.rotation, (3, 3)),
        ("rate", "", state.rate, (3,)),
        ("mass", "dynamics", dynamics and dynamics.mass_kg, ()),
        ("thrust scale", "dynamics", dynamics and dynamics.thrust_scale, ()),
        ("wind", "wind_map", inputs.wind_mps, (3,)),
        ("mass of the wind map", "wind_map", inputs.wind_map_mass_kg, ()),
        ("mass of the thrust", "normalise_thrust", inputs.thrust_mass_kg, ()),
        ("mass shown", "features", shown and shown.mass_kg, ()),
        ("thrust scale shown", "features", shown and shown.thrust_scale, ()),
        ("history code", "latent", inputs.code, (LATENT,)),
    )
    found: list[Lent | None] = []
    for name, place, part, rows in told:
        if place and place not in reads:
            found.append(None)
        elif part is None:
            raise ValueError(f"compiled rollout: the predictor reads {name} and was told none")
        else:
            found.append(lend(name, part.contiguous(), *rows, scenes, 1))
    return tuple(found)
