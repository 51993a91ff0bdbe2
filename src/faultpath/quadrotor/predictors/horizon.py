"""The horizon loop, compiled: all steps of a predictor for one tile of candidates at a time."""

import ctypes
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import IntEnum
from types import MappingProxyType
from typing import NamedTuple

import torch
from torch import Tensor

from faultpath.quadrotor.device import host_readable
from faultpath.quadrotor.native.lending import BLOCK, Block, Lent, fields, lend, pack
from faultpath.quadrotor.native.library import Kernels

LATENT, EMBEDDING, COMMAND, INCREMENTS = 32, 16, 4, 12
MOST_HIDDEN = 128
"""Fixed in `rollout.cpp`, as are the sizes below."""

_LOG2_E = 1 / math.log(2)
"""The kernel takes powers of two: scales of the unit's logistic functions go into its weights."""
_SCALES = {"gates": -_LOG2_E, "candidate": -2 * _LOG2_E, "remembered": -2 * _LOG2_E}


class Kind(IntEnum):
    """What a step is made of; `Kind` of `rollout.cpp`."""

    KINEMATIC = 0
    """The integrator."""
    ANCHORED = 1
    """The integrator, with bounded accelerations of a network added."""
    UNANCHORED = 2
    """Increments of a network."""


_SIZES = {Kind.ANCHORED: (19, 6), Kind.UNANCHORED: (21, INCREMENTS)}
"""Features that a network sees beside its latent, and its outputs."""
_LAYERS = ("embed", "gates", "candidate", "remembered", "first", "second", "last")


@dataclass(frozen=True)
class Step:
    """One step of a predictor but for its network; what its kind has no use for stays zero."""

    kind: Kind
    gravity: float
    windy: bool = False
    """The integrator has its wind term."""
    dragging: bool = False
    dt: float = 0.0
    keep: float = 0.0
    """What is left of a rate error at the end of the step."""
    mean: float = 0.0
    """And on average over it."""
    linear_bound: float = 0.0
    angular_bound: float = 0.0
    drag: tuple[float, ...] = (0.0, 0.0, 0.0)
    spread: tuple[float, ...] = (0.0,) * INCREMENTS
    """Of each increment, in units of the network's outputs."""


class Rolled(NamedTuple):
    """Where candidates led."""

    positions: Tensor
    """`[3, S, H, K]`, m."""
    velocities: Tensor
    """`[3, S, H, K]`, m/s."""
    rotation: Tensor
    """At the end, `[3, 3, S, K]`."""
    rate: Tensor
    """At the end, `[3, S, K]`, rad/s."""


_ROWS: Mapping[str, tuple[int, ...]] = MappingProxyType(
    {
        "position": (3,),
        "velocity": (3,),
        "rotation": (3, 3),
        "rate": (3,),
        "mass": (),
        "thrust_scale": (),
        "wind": (3,),
        "wind_mass": (),
        "thrust_mass": (),
        "shown_mass": (),
        "shown_scale": (),
        "code": (LATENT,),
    }
)
"""Rows of each input, in the order of `Inputs` of `rollout.cpp`."""


class _Layer(Block):
    _fields_ = (("weights", ctypes.c_void_p), *fields(ctypes.c_int64, "inputs outputs"))


class _Model(Block):
    """`Predictor` of `rollout.cpp`."""

    _fields_ = (
        *fields(ctypes.c_int64, "kind windy dragging"),
        *fields(_Layer, " ".join(_LAYERS)),
        *fields(ctypes.c_float, "dt keep mean gravity linear_bound angular_bound"),
        ("drag", ctypes.c_float * 3),
        ("spread", ctypes.c_float * INCREMENTS),
    )


class _Inputs(Block):
    """`Inputs` of `rollout.cpp`."""

    _fields_ = tuple((name, ctypes.c_void_p) for name in _ROWS)


def misfit(kind: Kind, layers: Mapping[str, Tensor]) -> str:
    """Return in words why the kernel takes no network of these layers; empty if it does.

    A layer is `[outputs, 1 + inputs]`, its biases first. The gates read embedding and latent in
    this order, the first hidden layer latent and features.
    """
    if kind is Kind.KINEMATIC:
        return "an integrator has no layers" if layers else ""
    if any(w.dtype != torch.float32 or not host_readable(w.device) for w in layers.values()):
        return "its weights are not float32 on the CPU"
    first, second = len(layers["first"]), len(layers["second"])
    if max(first, second) > MOST_HIDDEN:
        return f"its kernel has room for {MOST_HIDDEN} hidden units, not {max(first, second)}"
    features, outputs = _SIZES[kind]
    shapes = {
        "embed": (EMBEDDING, 1 + COMMAND),
        "gates": (2 * LATENT, 1 + EMBEDDING + LATENT),
        "candidate": (LATENT, 1 + EMBEDDING),
        "remembered": (LATENT, 1 + LATENT),
        "first": (first, 1 + LATENT + features),
        "second": (second, 1 + first),
        "last": (outputs, 1 + second),
    }
    wrong = [name for name, shape in shapes.items() if layers[name].shape != shape]
    return f"the size of its layer '{wrong[0]}' is another" if wrong else ""


class HorizonLoop:
    """Rolls candidates out, with a copy of the layers that it is made of."""

    def __init__(self, kernels: Kernels, step: Step, layers: Mapping[str, Tensor]) -> None:
        """Copy the layers; raises `ValueError` where `misfit` has a reason."""
        if why := misfit(step.kind, layers):
            raise ValueError(f"no compiled rollout: {why}")
        self._kernels = kernels
        laid: dict[str, _Layer] = {}
        for name, weights in layers.items():
            packed = pack(weights.detach() * _SCALES.get(name, 1.0), BLOCK)
            blocks, inputs, _ = packed.shape
            laid[name] = _Layer(lend(name, packed, *packed.shape), inputs - 1, blocks * BLOCK)
        self._model = _Model(**asdict(step), **laid)
        self._reads = _reads(step)

    def __call__(self, inputs: Mapping[str, Tensor | None], commands: Tensor) -> Rolled:
        """Roll `commands` `[H, 4, S, K]` out from what is known of S vehicles, `[*rows, S, 1]`.

        Inputs that the step has no use for are left out.

        Raises:
            ValueError: There is no step, or an input is missing.
        """
        horizon, _, scenes, candidates = commands.shape
        if not horizon:
            raise ValueError("there is no step to roll out: the commands have a horizon of 0")
        positions = commands.new_empty(3, scenes, horizon, candidates)
        velocities = torch.empty_like(positions)
        ends = commands.new_empty(12, scenes, candidates)
        given = [self._lend(name, inputs.get(name), scenes) for name in _ROWS]
        self._kernels.call(
            "faultpath_roll",
            *(self._model, _Inputs(*given)),
            lend("commands", commands.contiguous(), horizon, COMMAND, scenes, candidates),
            *(horizon, scenes, candidates),
            lend("positions", positions, 3, scenes, horizon, candidates),
            lend("velocities", velocities, 3, scenes, horizon, candidates),
            lend("ends", ends, 12, scenes, candidates),
        )
        return Rolled(positions, velocities, ends[:9].unflatten(0, (3, 3)), ends[9:])

    def _lend(self, name: str, value: Tensor | None, scenes: int) -> Lent | None:
        if name not in self._reads:
            return None
        if value is None:
            raise ValueError(f"compiled rollout: the predictor reads '{name}' and was told none")
        return lend(name, value.contiguous(), *_ROWS[name], scenes, 1)


def _reads(step: Step) -> frozenset[str]:
    reads = {"position", "velocity", "rotation", "rate"}
    if step.kind is not Kind.UNANCHORED:
        reads |= {"mass", "thrust_scale"}
    if step.windy:
        reads |= {"wind", "wind_mass"}
    if step.kind is not Kind.KINEMATIC:
        reads |= {"thrust_mass", "code"}
    if step.kind is Kind.UNANCHORED:
        reads |= {"shown_mass", "shown_scale"}
    return frozenset(reads)
