"""The runs of a check, and the form of its results."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

from faultpath.core.results import Result
from faultpath.run.attempt import Done
from faultpath.run.check.blocks import RecordedBlock
from faultpath.run.execution.recheck import deviation
from faultpath.system.declared import Variant
from faultpath.system.system import System

UNDER = "under the fault"
"""Begins why a variant was run under the user's fault; its condition follows."""


class Check(Result):
    """One thing that was looked at."""

    name: str
    says: str
    """One line on what was seen, or on why nothing could be."""
    failures: tuple[str, ...] = ()
    """A sentence each: what is wrong, where, and what to do."""
    remarks: tuple[str, ...] = ()
    """Sentences on what may be a mistake and may be none."""
    judged: bool = True

    @property
    def status(self) -> Literal["passed", "failed", "not judged"]:
        """Result of the check in a word."""
        if self.failures:
            return "failed"
        return "passed" if self.judged else "not judged"


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

    def under(self) -> Iterator[tuple[str, RecordedBlock]]:
        """Yield the runs under the user's fault, each with its variant and condition in words."""
        for (variant, why, _), run in self.runs.items():
            if why.startswith(UNDER):
                yield f"Variant '{variant}', {why}", run

    def unsteady(self) -> list[str]:
        """Return the variants of which a second run differs from the first."""
        return [variant for variant, _ in self.firsts() if self.differs(variant, "again")]

    def differs(self, variant: str, why: str, base: str = "first") -> str:
        """Say how a run of a variant differs from its first one; empty where it does not."""
        first, again = self.of(variant, base), self.of(variant, why)
        if error := again.error or first.error:
            return f"fails where the first did not ({error})"
        if not again.outcomes:
            return ""
        odd = [key for key, digest in again.clean.items() if first.clean.get(key) != digest]
        by_scene = {outcome.scene: outcome for outcome in first.outcomes}
        before = [by_scene[outcome.scene] for outcome in again.outcomes]
        words = str(deviation(before, Done(again.outcomes, ())) or "")
        if odd:
            scene, step, channel, reader = min(odd, key=lambda key: key[1])
            words = words or "differs in its readings alone"
            words += f", first at step {step} in {channel} -> {reader}, scene {scene!r}"
        return words
