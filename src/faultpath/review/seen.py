"""All that was flown in a check, and how two flights differ."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from faultpath.execution.attempt import Done
from faultpath.execution.differences import difference
from faultpath.review.flights import Flight, Flown
from faultpath.taps import Read
from faultpath.trials import Outcome, System, Variant


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


def _chosen(outcomes: Sequence[Outcome], scenes: Sequence[str]) -> list[Outcome]:
    by_scene = {outcome.scene: outcome for outcome in outcomes}
    return [by_scene[scene] for scene in scenes]


def _tap(read: Read) -> str:
    return f"tap {read.channel} -> {read.consumer}"
