"""What each compiled kernel buys: the same flights with all kernels, and without one of them."""

import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from benchmarks.comparison import Comparison, Outcome, absolute, unmeasured
from benchmarks.flights import SCENES, WHOLE, ClosedLoop
from benchmarks.measure import NotMeasured, Running, Work
from benchmarks.results import Record
from faultpath.quadrotor import native, system
from faultpath.quadrotor.modules import prediction
from faultpath.quadrotor.perception import DepthRenderer, seen
from faultpath.quadrotor.planner import (
    AutoregressiveSampler,
    NavigationCost,
    Sampler,
    ScaledTemperature,
    mppi,
)
from faultpath.quadrotor.plant import TorchPlant
from faultpath.quadrotor.predictors.network import GatedCell
from faultpath.quadrotor.scenes.field import DistanceField

KERNELS: Mapping[str, tuple[Any, str, tuple[str, ...]]] = {
    "rollout": (prediction, "rolling", ("rollout",)),
    "clearance queries": (seen, "_queries", ("clearance queries",)),
    "depth encoder": (seen, "_encoder", ("encoding",)),
    "depth renderer": (DepthRenderer, "__init__", ("rendering",)),
    "distance field": (DistanceField, "query", ("clearance queries",)),
    "noise": (AutoregressiveSampler, "noise", ("noise",)),
    "candidates": (Sampler, "candidates", ("candidates",)),
    "costs": (NavigationCost, "__call__", ("costs and update",)),
    "weights": (ScaledTemperature, "weights", ("costs and update",)),
    "weighted mean": (mppi, "weighted_mean", ("costs and update",)),
    "plant and contact": (TorchPlant, "__init__", ("plant and contact",)),
    "recurrent cells": (GatedCell, "last", ("history code", "wind reconstruction")),
}
"""Where each kernel is chosen, and the parts of a control step that change without it: what is
called there under `native.using(PORTABLE)` goes without."""

SEEN = tuple(name for name in KERNELS if name != "distance field")
JOBS: Sequence[tuple[str, dict[str, Any], tuple[str, ...], int]] = (
    ("Main job", {"clearance": "depth", "scenes": SCENES}, SEEN, 3),
    ("Main job of 5 scenes", {"clearance": "depth", "scenes": 5}, SEEN, 7),
    ("Ground-truth clearance", {"clearance": "true", "scenes": SCENES}, ("distance field",), 5),
)
"""Flights, the kernels that run in them, and rounds."""

LEAST = 2.0
"""Per cent of the flights that a kernel should buy to be worth its code."""


class Ablation(ClosedLoop):
    """Real flights, and how much longer they take without single kernels."""

    def __init__(self, clearance: str, scenes: int, kernels: Sequence[str], rounds: int) -> None:
        super().__init__(clearance, scenes)
        self._kernels, self._rounds = kernels, rounds

    def answer(self) -> Sequence[float]:
        """Return, round by round, per cent of the flights that each kernel buys."""
        return [bought for _ in range(self._rounds) for bought in self._round()]

    def _round(self) -> Iterator[float]:
        """Only the parts that a kernel changes are compared: the rest is noise."""
        whole = self._fresh()
        for name in self._kernels:
            *_, parts = KERNELS[name]
            with without(name):
                fewer = self._fresh()
            yield 100 * sum(fewer[part] - whole[part] for part in parts) / whole[WHOLE]

    def _fresh(self) -> dict[str, float]:
        for kept in (system._renderer, system._field):
            kept.cache_clear()  # they hold what chose a kernel
        return self.spent(repeats=1)


@contextmanager
def without(kernel: str) -> Iterator[None]:
    """Let the portable form of one kernel run."""
    owner, name, _ = KERNELS[kernel]
    original: Callable[..., Any] = getattr(owner, name)

    def portable(*given: Any, **named: Any) -> Any:
        with native.using(native.PORTABLE):
            return original(*given, **named)

    setattr(owner, name, portable)
    try:
        yield
    finally:
        setattr(owner, name, original)


def kernels() -> Outcome:
    """Fly with all kernels and without each."""
    records: list[Record] = []
    for words, flights, names, rounds in JOBS:
        given = {**flights, "kernels": names, "rounds": rounds}
        try:
            with Running(Work("benchmarks.ablation:Ablation", given)) as side:
                found = list(zip(*[iter(side.answer())] * len(names), strict=True))
        except NotMeasured as reason:
            records.append(unmeasured("kernels", f"{words}: kernels", str(reason)))
            continue
        bought = dict(zip(names, zip(*found, strict=True), strict=True))
        for name, values in bought.items():
            records.append(_record(f"{words}: {name}", values))
        small = [values for values in bought.values() if statistics.median(values) < LEAST]
        if len(small) > 1:
            together = [sum(each) for each in zip(*small, strict=True)]
            records.append(_record(f"{words}: those below {LEAST:g} %, together", together))
    return Outcome(records)


def _record(name: str, bought: Sequence[float]) -> Record:
    return absolute("kernels", name, bought, "%")


COMPARISONS = (Comparison("kernels", kernels),)
