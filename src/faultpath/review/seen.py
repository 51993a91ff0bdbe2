"""All that was flown in a check, and how two flights differ."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from faultpath.execution.attempt import Done
from faultpath.execution.differences import difference
from faultpath.review.flights import Flight, Flown
from faultpath.taps import Read
from faultpath.trials import Outcome, System, Variant

_FEW = 1e-12
"""Of a number in double precision: what other orders of a sum leave after some steps."""


@dataclass
class Seen:
    """The flights of a check, by variant and why they were flown."""

    system: System
    variants: tuple[Variant, ...]
    scenes: tuple[str, ...]
    seed: int
    apart: bool
    """Whether flights were flown again in processes of their own."""
    flights: dict[tuple[str, str], tuple[Flight, Flown]] = field(
        default_factory=dict[tuple[str, str], tuple[Flight, Flown]]
    )

    def of(self, variant: str, why: str) -> Flown:
        """Return what was seen of a flight; nothing where there was none."""
        return self.flights[variant, why][1] if (variant, why) in self.flights else Flown()

    def firsts(self) -> Iterator[tuple[str, Flown]]:
        """Yield the first flight, under correct inputs, of each variant that flew to its end."""
        for variant in self.variants:
            flown = self.of(variant.name, "first")
            if flown.outcomes and not flown.error:
                yield variant.name, flown

    def errors(self, check: str) -> tuple[str, ...]:
        """Return what stopped flights under correct inputs, as far as `check` tells of it."""
        found = {
            flown.error: variant
            for (variant, why), (_, flown) in reversed(self.flights.items())
            if flown.blames == check and not why.startswith("struck")
        }
        return tuple(f"Variant '{variant}': {error}" for error, variant in found.items())

    def other(self, variant: str, why: str) -> str:
        """Say how a second flight of a variant differs from the first; empty where it does not."""
        first, again = self.of(variant, "first"), self.flights.get((variant, why))
        if again is None:
            return ""
        flight, flown = again
        if flown.error:
            return f"fails where the first did not ({flown.error})"
        before = _chosen(first.outcomes, flight.scenes)
        apart = self.parting(first, flight, flown)
        differs = difference(before, Done(flown.outcomes, (), 0.0))
        if not differs and not apart:
            return ""
        return f"{differs or 'differs in its readings alone'}{f', {apart}' if apart else ''}"

    def size(self, variant: str, why: str) -> float:
        """Return by how much of their size the numbers of a second flight differ at most;
        infinite where it ends otherwise."""
        first, (flight, flown) = self.of(variant, "first"), self.flights[variant, why]
        if flown.error:
            return math.inf
        before = _chosen(first.outcomes, flight.scenes)
        whole: dict[str, float] = {}  # a metric may end near zero; what rounding does to it is not
        for name, value in ((n, v) for o in first.outcomes for n, v in o.metrics.items()):
            whole[name] = max(whole.get(name, 0.0), abs(value or 0.0))
        found = [_size(a, b, whole) for a, b in zip(before, flown.outcomes, strict=True)]
        now = {(read.step, *read.tap): read for read in flown.reads}
        ends = {o.scene: math.ceil(o.time_s / self.system.control_dt_s) for o in first.outcomes}
        for read in first.reads:
            if (other := now.get((read.step, *read.tap))) is None or not other.sums:
                continue
            places = [at for at, scene in enumerate(flight.scenes) if read.step < ends[scene]]
            for at in places:
                (a, size), (b, _) = read.sums[self.scenes.index(flight.scenes[at])], other.sums[at]
                found.append(_relative(a, b, size))
        return max(found, default=0.0)

    @property
    def rounding(self) -> float:
        """What rounding may change of a number's size: a few units in its last place."""
        kinds = {read.dtype for _, flown in self.flights.values() for read in flown.reads}
        coarsest = max(
            (float(np.finfo(kind).eps) for kind in kinds if kind.startswith("float")), default=0.0
        )
        return max(_FEW, 4 * coarsest)

    def parting(self, first: Flown, flight: Flight, flown: Flown) -> str:
        """Say where two flights first bring different readings, while the scene runs in both."""
        now = {(read.step, *read.tap): read for read in flown.reads}
        ends = {o.scene: math.ceil(o.time_s / self.system.control_dt_s) for o in first.outcomes}
        for read in first.reads:
            other = now.get((read.step, *read.tap))
            for at, scene in enumerate(flight.scenes):
                if other is None or read.step >= ends[scene] or not (other.given and read.given):
                    continue
                if other.given[at] != read.given[self.scenes.index(scene)]:
                    return f"first at step {read.step} in {_tap(read)}, scene {scene!r}"
        return ""


def _size(one: Outcome, two: Outcome, whole: Mapping[str, float]) -> float:
    ends = [
        (o.status, o.initial_hash, o.disturbance_hash, o.planner_noise_hash) for o in (one, two)
    ]
    if ends[0] != ends[1] or set(one.metrics) != set(two.metrics):
        return math.inf
    found = [_relative(one.time_s, two.time_s, one.time_s)]
    for name, a in one.metrics.items():
        if (a is None) != ((b := two.metrics[name]) is None):
            return math.inf
        if a is not None and b is not None:
            found.append(_relative(a, b, whole[name]))
    if one.trace is not None and two.trace is not None:
        if one.trace.shape != two.trace.shape:
            return math.inf
        apart = float(np.abs(one.trace - two.trace).max(initial=0.0))
        size = float(np.abs(one.trace).max(initial=0.0))
        # A trace is kept in single precision, whatever the numbers were computed in.
        found.append(0.0 if apart <= 4 * np.finfo(np.float32).eps * size else apart / size)
    return max(found)


def _relative(a: float, b: float, whole: float) -> float:
    return abs(a - b) / whole if a != b and whole else float(a != b)


def _chosen(outcomes: Sequence[Outcome], scenes: Sequence[str]) -> list[Outcome]:
    by_scene = {outcome.scene: outcome for outcome in outcomes}
    return [by_scene[scene] for scene in scenes]


def _tap(read: Read) -> str:
    return f"tap {read.channel} -> {read.consumer}"
