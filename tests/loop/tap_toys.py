"""A small system and a way to play readings through its taps."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from faultpath import faults as kinds
from faultpath.core.streams import generator
from faultpath.faults import Fault, resolve
from faultpath.interface import read_interface
from faultpath.loop import Reading, Taps

DT_S = 0.05
SHAPES = {"mass": (), "wind": (3,)}
INTERFACE = read_interface("""
name: toy
sources:
- {name: scale, unit: kg, provenance: estimated}
- {name: still, unit: m/s, shape: [3], provenance: constant}
- {name: truth, unit: m/s, shape: [3], provenance: privileged}
channels:
- name: mass
  sources: [scale]
  readers: [predictor.dynamics, observer.model]
  erasure_default: 1.0
- name: wind
  sources: [still, truth]
  readers: [predictor.wind, planner.wind]
  erasure_default: [0.0, 0.0, 1.0]
""")
SOURCES = {"mass": "scale", "wind": "still"}

INTERVENTIONS: tuple[kinds.Intervention, ...] = (
    kinds.Scale(factor=1.1),
    kinds.UniformScale(half_range=0.2),
    kinds.Offset(by=0.1),
    kinds.Offset(by=(0.1, 0.0, -0.2)),
    kinds.Rotate(by=(0.1, 0.0, -0.2)),
    kinds.Quantise(step_size=0.25),
    kinds.Erase(),
    kinds.Noise(std=0.3),
    kinds.Noise(std=0.3, relative=True),
    kinds.Drift(rate_per_s=(1.0, 0.0, 2.0)),
    kinds.Drift(walk_per_sqrt_s=0.5),
    kinds.Bias(std=(0.3, 0.1, 0.2)),
    kinds.Bias(std=0.3, relative=True, time_constant_s=0.2),
    kinds.Delay(steps=3),
    kinds.Hold(every=4),
    kinds.Freeze(),
    kinds.Dropout(probability=0.4),
    kinds.Dropout(probability=0.4, substitute=kinds.Erase()),
    kinds.Shuffle(axis=1),
    kinds.Sequence(parts=(kinds.Scale(factor=1.1), kinds.Noise(std=0.1), kinds.Delay(steps=2))),
)


def series(scene: str, channel: str, steps: int) -> np.ndarray[Any, Any]:
    """Return a scene's readings `[T, ...]`, whatever runs beside it."""
    return generator("series", scene, 0).normal(size=(steps, *SHAPES[channel]))


def make(faults: Iterable[Fault] = (), scenes: Sequence[str] = "ab", **more: Any) -> Taps:
    found = resolve(faults, INTERFACE, more.get("readers"))
    return Taps(INTERFACE, found, scenes=tuple(scenes), dt_s=DT_S, **more)


def play(
    faults: Iterable[Fault],
    scenes: Sequence[str],
    *,
    reader: str = "predictor.wind",
    channel: str = "wind",
    to: Any = np.asarray,
    steps: int = 16,
    **more: Any,
) -> np.ndarray[Any, Any]:
    """Return what `reader` gets, `[T, B, ...]`."""
    taps = make(faults, scenes, **more)
    readings = np.stack([series(scene, channel, steps) for scene in scenes], axis=1)
    shown = [Reading(to(readings[step]), SOURCES[channel], step) for step in range(steps)]
    values = (taps.deliver(channel, reader, each, step) for step, each in enumerate(shown))
    return np.stack([np.asarray(value) for value in values])
