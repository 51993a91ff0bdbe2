"""What each compiled kernel buys: the same flights with all kernels, and without one of them."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from statistics import median
from typing import Any

from benchmarks.comparison import Case, Effort
from benchmarks.flights import SCENES, WHOLE, ClosedLoop, replaced
from benchmarks.measure import Running, Work
from benchmarks.results import Record, record
from faultpath.quadrotor import native, system
from faultpath.quadrotor.perception import DepthRenderer, seen
from faultpath.quadrotor.planners import (
    AutoregressiveSampler,
    NavigationCost,
)
from faultpath.quadrotor.plant import TorchPlant
from faultpath.quadrotor.predictors import module as prediction
from faultpath.quadrotor.predictors.network import GatedCell
from faultpath.quadrotor.scenes.field import DistanceField

KERNELS: Mapping[str, tuple[Any, str, tuple[str, ...]]] = {
    "rollout": (prediction, "rolling", ("rollout",)),
    "clearance queries": (seen, "_queries", ("clearance queries",)),
    "depth encoder": (seen, "_encoder", ("encoding",)),
    "depth renderer": (DepthRenderer, "__init__", ("rendering",)),
    "distance field": (DistanceField, "query", ("clearance queries",)),
    "noise": (AutoregressiveSampler, "noise", ("noise",)),
    "costs": (NavigationCost, "__call__", ("costs and update",)),
    "plant and contact": (TorchPlant, "__init__", ("plant and contact",)),
    "recurrent cells": (GatedCell, "last", ("history code", "wind reconstruction")),
}
"""Where each kernel is chosen, and the parts of a control step that change without it: what is
called there under `native.using(PORTABLE)` goes without."""

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
        for owner, name, parts in map(KERNELS.__getitem__, self._kernels):
            with replaced(owner, name, _portable(getattr(owner, name))):
                fewer = self._fresh()
            yield 100 * sum(fewer[part] - whole[part] for part in parts) / whole[WHOLE]

    def _fresh(self) -> dict[str, float]:
        for kept in (system._renderer, system._field):
            kept.cache_clear()  # they hold what chose a kernel
        return self.spent(repeats=1)


def _portable(original: Callable[..., Any]) -> Callable[..., Any]:
    def portable(*given: Any, **named: Any) -> Any:
        with native.using(native.PORTABLE):
            return original(*given, **named)

    return portable


def _fly(
    words: str, clearance: str, scenes: int, kernels: Sequence[str], rounds: int, effort: Effort
) -> Iterator[Record]:
    """Fly with all kernels and without each."""
    given = {"clearance": clearance, "scenes": effort.of(scenes), "kernels": kernels}
    given["rounds"] = effort.of(rounds)
    with Running(Work("benchmarks.ablation:Ablation", given)) as side:
        found = list(zip(*[iter(side.answer())] * len(kernels), strict=True))
    bought = dict(zip(kernels, zip(*found, strict=True), strict=True))
    for name, values in bought.items():
        yield record(f"{words}: {name}", "%", values)
    small = [values for values in bought.values() if median(values) < LEAST]
    if len(small) > 1:
        together = [sum(each) for each in zip(*small, strict=True)]
        yield record(f"{words}: those below {LEAST:g} %, together", "%", together)


_SEEN = tuple(name for name in KERNELS if name != "distance field")
_JOBS: Mapping[str, tuple[str, int, tuple[str, ...], int]] = {
    "Main job": ("depth", SCENES, _SEEN, 3),
    "Main job of 5 scenes": ("depth", 5, _SEEN, 7),
    "Ground-truth clearance": ("true", SCENES, ("distance field",), 5),
}
"""Clearance and scenes of some flights, the kernels that run in them, and rounds."""

CASES: Mapping[str, Case] = {
    f"{words}: kernels": partial(_fly, words, *job) for words, job in _JOBS.items()
}
