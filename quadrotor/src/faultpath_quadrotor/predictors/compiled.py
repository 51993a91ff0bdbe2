"""The horizon loop, compiled: all steps of a predictor for one tile of candidates at a time.

It replaces exactly the shipped predictors, at its sizes. A subclass may step differently, so it
runs as it is, on the portable path.
"""

import ctypes
import math
from collections.abc import Iterable, Mapping
from enum import IntEnum
from types import MappingProxyType
from typing import Any

import torch
from torch import Tensor

from faultpath_quadrotor.batching import Delivered, Read
from faultpath_quadrotor.device import host_readable
from faultpath_quadrotor.native.kernel_args import (
    BLOCK,
    Block,
    Lent,
    fields,
    is_exactly,
    lend,
    output,
    pack,
    unlike,
)
from faultpath_quadrotor.native.library import Kernels
from faultpath_quadrotor.predictors.anchored import (
    ANGULAR_BOUND_RADPS2,
    LINEAR_BOUND_MPS2,
    AnchoredPredictor,
)
from faultpath_quadrotor.predictors.base import Predictor, PredictorInputs, Rollout
from faultpath_quadrotor.predictors.kinematic import KEEP, MEAN, KinematicIntegrator, LinearDrag
from faultpath_quadrotor.predictors.network import (
    ACTION_EMBEDDING,
    ACTION_FEATURES,
    LATENT,
    LatentNetwork,
)
from faultpath_quadrotor.predictors.unanchored import (
    OUTPUTS,
    UnanchoredNetwork,
    UnanchoredPredictor,
)
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import CONTROL_DT_S, GRAVITY_MPS2

MOST_HIDDEN = 128
"""Fixed in `rollout.cpp`, as are the other sizes."""

_LOG2_E = 1 / math.log(2)
"""The kernel takes powers of two: scales of the unit's logistic functions go into its weights."""
_SCALES = {"gates": -_LOG2_E, "candidate": -2 * _LOG2_E, "remembered": -2 * _LOG2_E}
_LAYERS = ("embed", "gates", "candidate", "remembered", "first", "second", "last")


class _Kind(IntEnum):
    """Kind of step; `Kind` of `rollout.cpp`."""

    KINEMATIC = 0
    ANCHORED = 1
    UNANCHORED = 2


_SIZES = {_Kind.ANCHORED: (19, 6), _Kind.UNANCHORED: (21, OUTPUTS)}
"""Features that a network sees beside its latent, and its outputs."""

_ROWS: Mapping[Read, tuple[int, ...]] = MappingProxyType(
    {
        ("position", "initial_state"): (3,),
        ("velocity", "initial_state"): (3,),
        ("attitude", "initial_state"): (3, 3),
        ("body_rate", "initial_state"): (3,),
        ("mass", "dynamics"): (),
        ("thrust_scale", "dynamics"): (),
        ("mass", "wind_map"): (),
        ("wind", "wind_map"): (3,),
        ("mass", "normalise_thrust"): (),
        ("mass", "features"): (),
        ("thrust_scale", "features"): (),
        ("history_code", "latent"): (LATENT,),
    }
)
"""Rows of each reading, in the order of `Inputs` of `rollout.cpp`."""


class _Layer(Block):
    _fields_ = (("weights", ctypes.c_void_p), *fields(ctypes.c_int64, "inputs outputs"))


class _Model(Block):
    """`Predictor` of `rollout.cpp`; fields that a kind does not use stay zero."""

    _fields_ = (
        *fields(ctypes.c_int64, "kind windy dragging"),
        *fields(_Layer, " ".join(_LAYERS)),
        *fields(ctypes.c_float, "dt keep mean gravity linear_bound angular_bound"),
        ("drag", ctypes.c_float * 3),
        ("spread", ctypes.c_float * OUTPUTS),
    )


class _Inputs(Block):
    """`Inputs` of `rollout.cpp`."""

    _fields_ = tuple((f"{channel}_at_{place}", ctypes.c_void_p) for channel, place in _ROWS)


def uncovered(predictor: Predictor) -> str:
    """Return in words why no compiled loop may replace `predictor`; empty where one may."""
    if is_exactly(predictor, UnanchoredPredictor):
        return _network(predictor.network, UnanchoredNetwork, _Kind.UNANCHORED)
    if is_exactly(predictor, AnchoredPredictor):
        network = _network(predictor.network, LatentNetwork, _Kind.ANCHORED)
        return network or _integrator(predictor.kinematics)
    if isinstance(predictor, KinematicIntegrator):
        return _integrator(predictor)
    for kind in (UnanchoredPredictor, AnchoredPredictor):
        if isinstance(predictor, kind):
            return unlike(kind, predictor)
    return "there is a kernel of the shipped predictors only"


class HorizonLoop:
    """Rolls candidates out, with a copy of the weights that the predictor has now."""

    def __init__(self, kernels: Kernels, predictor: Predictor) -> None:
        """Copy the weights; raises `ValueError` where `uncovered` has a reason."""
        if why := uncovered(predictor):
            raise ValueError(f"no compiled rollout of {type(predictor).__name__}: {why}")
        self._kernels = kernels
        self._reads = predictor.reads
        step: dict[str, Any] = {"kind": _Kind.KINEMATIC, "gravity": GRAVITY_MPS2}
        integrator = predictor if isinstance(predictor, KinematicIntegrator) else None
        if isinstance(predictor, UnanchoredPredictor):
            spread = tuple(predictor.network.increment_std.flatten().tolist())
            step |= {"kind": _Kind.UNANCHORED, "spread": spread, **_packed(predictor.network)}
        elif isinstance(predictor, AnchoredPredictor):
            integrator = predictor.kinematics
            step |= {
                "kind": _Kind.ANCHORED,
                "linear_bound": LINEAR_BOUND_MPS2,
                "angular_bound": ANGULAR_BOUND_RADPS2,
                **_packed(predictor.network),
            }
        if integrator is not None:
            step |= {"dt": CONTROL_DT_S, "keep": KEEP, "mean": MEAN, "dragging": integrator.drag}
            step |= {"windy": "wind_map" in integrator.reads}
            step |= {"drag": integrator.air.coefficients_kgps}
        self._model = _Model(**step)

    def __call__(self, inputs: PredictorInputs, commands: Tensor) -> Rollout:
        """Roll `commands` `[H, 4, S, K]` out from `inputs`, whose batch is `[S, 1]`.

        Raises:
            ValueError: There is no step, or an input is missing.
        """
        horizon, _, scenes, candidates = commands.shape
        if not horizon:
            raise ValueError("there is no step to roll out: the commands have a horizon of 0")
        positions, velocities = (output(3, scenes, horizon, candidates) for _ in range(2))
        ends = output(12, scenes, candidates)
        readings = {**dict(zip(_ROWS, inputs.state.parts, strict=False)), **inputs.delivered}
        self._kernels.call(
            "faultpath_roll",
            *(self._model, _Inputs(*self._lent(readings, scenes))),
            lend("commands", commands, horizon, ACTION_FEATURES, scenes, candidates),
            *(horizon, scenes, candidates, positions, velocities, ends),
        )
        moved, pushed, (turned, rate) = positions.tensor, velocities.tensor, ends.tensor.split(9)
        final = State(moved[:, :, -1], pushed[:, :, -1], turned.unflatten(0, (3, 3)), rate)
        return Rollout(moved, pushed, final)

    def _lent(self, readings: Delivered, scenes: int) -> Iterable[Lent | None]:
        for read, rows in _ROWS.items():
            channel, place = read
            if place not in self._reads:
                yield None
            elif read not in readings:
                raise ValueError(
                    f"compiled rollout: the predictor reads {channel} at {place!r} and was told "
                    "none"
                )
            else:
                yield lend(channel, readings[read], *rows, scenes, 1)


def _integrator(integrator: KinematicIntegrator) -> str:
    if not is_exactly(integrator, KinematicIntegrator):
        return unlike(KinematicIntegrator, integrator)
    air = integrator.air
    return "" if is_exactly(air, LinearDrag) else unlike(LinearDrag, air)


def _network(network: LatentNetwork, exactly: type[LatentNetwork], kind: _Kind) -> str:
    """Return in words why the kernel takes no such network; empty if it does."""
    if not is_exactly(network, exactly):
        return unlike(exactly, network)
    tensors = (*network.parameters(), *network.buffers())
    if any(part.dtype != torch.float32 or not host_readable(part.device) for part in tensors):
        return "its weights are not float32 on the CPU"
    if isinstance(network, UnanchoredNetwork) and network.increment_std.shape != (OUTPUTS, 1):
        return "the size of its layer 'increment_std' is another"
    layers = _layers(network)
    first, second = len(layers["first"]), len(layers["second"])
    if max(first, second) > MOST_HIDDEN:
        return f"its kernel has room for {MOST_HIDDEN} hidden units, not {max(first, second)}"
    features, outputs = _SIZES[kind]
    shapes = {
        "embed": (ACTION_EMBEDDING, 1 + ACTION_FEATURES),
        "gates": (2 * LATENT, 1 + ACTION_EMBEDDING + LATENT),
        "candidate": (LATENT, 1 + ACTION_EMBEDDING),
        "remembered": (LATENT, 1 + LATENT),
        "first": (first, 1 + LATENT + features),
        "second": (second, 1 + first),
        "last": (outputs, 1 + second),
    }
    wrong = [name for name, shape in shapes.items() if layers[name].shape != shape]
    return f"the size of its layer '{wrong[0]}' is another" if wrong else ""


def _packed(network: LatentNetwork) -> dict[str, _Layer]:
    """Return the layers as they lie for the kernel."""
    laid: dict[str, _Layer] = {}
    for name, weights in _layers(network).items():
        packed = pack(weights.detach() * _SCALES.get(name, 1.0), BLOCK)
        blocks, inputs, _ = packed.shape
        laid[name] = _Layer(lend(name, packed, *packed.shape), inputs - 1, blocks * BLOCK)
    return laid


@torch.no_grad()
def _layers(network: LatentNetwork) -> Mapping[str, Tensor]:
    """Return each layer as `[outputs, 1 + inputs]`, its biases first.

    The gates read embedding and latent in this order, the first hidden layer latent and features.
    """
    folded = network.fold()
    split, gates = ACTION_EMBEDDING, folded.gates
    return {
        "embed": _bias_first(folded.embed[:-1]),
        "gates": torch.cat(
            (gates[:, split : split + 1], gates[:, :split], gates[:, split + 1 :]), 1
        ),
        "candidate": _bias_first(folded.candidate),
        "remembered": folded.remembered,
        "first": _bias_first(folded.first[:-1]),
        "second": _bias_first(folded.second[:-1]),
        "last": _bias_first(folded.last),
    }


def _bias_first(weights: Tensor) -> Tensor:
    return weights.roll(1, dims=1)
