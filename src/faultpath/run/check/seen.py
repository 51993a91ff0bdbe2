"""The runs of a check."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from faultpath.run.attempt import Done
from faultpath.run.check.blocks import RecordedBlock
from faultpath.run.check.results import Difference
from faultpath.run.execution.recheck import deviation
from faultpath.system.declared import Variant
from faultpath.system.system import System

UNDER = "under the fault: "
"""Begins why a variant was run under the user's fault; its condition follows."""


@dataclass
class Seen:
    """The runs of a check."""

    system: System
    variants: tuple[Variant, ...]
    scenes: tuple[str, ...]
    seed: int
    apart: bool
    """Whether runs were repeated in processes of their own."""
    runs: dict[tuple[str, str, tuple[str, str]], RecordedBlock] = field(
        default_factory=dict[tuple[str, str, tuple[str, str]], RecordedBlock]
    )
    """By variant, why it was run, and the tap that was faulted alone."""

    def of(self, variant: str, why: str, tap: tuple[str, str] = ("", "")) -> RecordedBlock:
        """Return what was recorded of a run; nothing where there was none."""
        return self.runs.get((variant, why, tap), RecordedBlock())

    def firsts(self) -> Iterator[tuple[str, RecordedBlock]]:
        """Yield the first run, under correct inputs, of each variant that came to its end."""
        for variant in self.variants:
            run = self.of(variant.name, "first")
            if run.outcomes:
                yield variant.name, run

    def under(self) -> Iterator[tuple[str, str, RecordedBlock]]:
        """Yield the runs under the user's fault, each with its variant and condition."""
        for (variant, why, _), run in self.runs.items():
            if why.startswith(UNDER):
                yield variant, condition_of(why), run

    def unsteady(self) -> list[str]:
        """Return the variants of which a second run differs from the first."""
        return [variant for variant, _ in self.firsts() if self.difference(variant, "again")]

    def difference(self, variant: str, why: str, base: str = "first") -> Difference | None:
        """Return how a run of a variant differs from its first one; `None` where it does not."""
        first, again = self.of(variant, base), self.of(variant, why)
        if error := again.error or first.error:
            return Difference(error=error)
        if not again.outcomes:
            return None
        odd = [key for key, digest in again.clean.items() if first.clean.get(key) != digest]
        by_scene = {outcome.scene: outcome for outcome in first.outcomes}
        before = [by_scene[outcome.scene] for outcome in again.outcomes]
        outcomes = deviation(before, Done(again.outcomes, ()))
        if outcomes is None and not odd:
            return None
        reading = min(odd, key=lambda key: key[1], default=None)
        return Difference(outcomes=outcomes, reading=reading)


def condition_of(why: str) -> str:
    """Return the condition of the user's fault under which a variant was run; empty without it."""
    return why.removeprefix(UNDER) if why.startswith(UNDER) else ""
