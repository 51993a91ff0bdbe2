"""The horizon loop, compiled: all steps of a predictor for one tile of candidates at a time."""

import ctypes
import math

import torch
from torch import Tensor

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
from faultpath.quadrotor.predictors.network import ACTION_EMBEDDING, FoldedNetwork
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
        self._kernels = kernels
        self._kept: list[Tensor] = []  # the kernel holds addresses only
        self._model = _Model(gravity=GRAVITY_MPS2)
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
        else:
            raise TypeError(f"no compiled rollout of {type(predictor).__name__}")

    @staticmethod
    def covers(predictor: Predictor) -> bool:
        """Return whether there is a compiled rollout of `predictor`."""
        kinds = (UnanchoredPredictor, AnchoredPredictor, KinematicIntegrator)
        return isinstance(predictor, kinds)

    def __call__(self, inputs: PredictorInputs, commands: Tensor) -> Rollout:
        """Roll `commands` `[H, 4, S, K]` out from `inputs`, whose batch is `[S, 1]`."""
        horizon, _, scenes, candidates = commands.shape
        positions = commands.new_empty(3, scenes, horizon, candidates)
        velocities = torch.empty_like(positions)
        ends = commands.new_empty(12, scenes, candidates)
        told = _told(inputs)
        self._kernels.call(
            "faultpath_roll",
            ctypes.byref(self._model),
            ctypes.byref(_Inputs(*(part if part is None else part.data_ptr() for part in told))),
            commands.contiguous(),
            *(horizon, scenes, candidates),
            *(positions, velocities, ends),
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
            self._kept.append(packed)
            outputs = packed.shape[0] * block
            layer = _Layer(packed.data_ptr(), packed.shape[1] - 1, outputs)
            setattr(self._model, name, layer)
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


def _told(inputs: PredictorInputs) -> tuple[Tensor | None, ...]:
    """Return the tensors of `Inputs` of `rollout.cpp`, each `[rows, S]` in memory."""
    state, dynamics, shown = inputs.state, inputs.dynamics, inputs.conditioning
    told = (
        *(state.position, state.velocity, state.rotation, state.rate),
        *((None, None) if dynamics is None else (dynamics.mass_kg, dynamics.thrust_scale)),
        *(inputs.wind_mps, inputs.wind_map_mass_kg, inputs.thrust_mass_kg),
        *((None, None) if shown is None else (shown.mass_kg, shown.thrust_scale)),
        inputs.code,
    )
    return tuple(None if part is None else part.contiguous() for part in told)
