"""Deliveries of the taps, and what they and the trials show of a system's declarations."""

from collections.abc import Iterable, Mapping
from typing import Literal, Self, TypeAlias

from faultpath.core.results import Result
from faultpath.loop import TapCount, added
from faultpath.run.findings import Finding, Unproven, Unread
from faultpath.run.plan import Plan
from faultpath.run.trials import Trials

TreatmentPart: TypeAlias = tuple[str, tuple[str, ...]]
"""Key of a treatment, and what its rows say of their scenes."""


class RowDeliveries(Result):
    """The taps of one row of a plan."""

    variant: str
    condition: str
    seed: int
    taps: tuple[TapCount, ...]
    """In the order of the interface; empty where every trial failed."""


class Deliveries(Result):
    """The taps of a plan, row by row; written as `deliveries.json`."""

    format: Literal[2] = 2
    rows: tuple[RowDeliveries, ...] = ()
    findings: tuple[Finding, ...] = ()
    """Findings that a reader of the run's results has to know."""

    @classmethod
    def of(
        cls,
        plan: Plan,
        treatments: Mapping[TreatmentPart, tuple[TapCount, ...]],
        trials: Trials,
        findings: tuple[Finding, ...],
    ) -> Self:
        """Lay the counts out in the order of the plan's rows.

        To `findings` it adds what counts and outcomes show of the declarations.
        """
        rows = tuple(
            RowDeliveries(
                variant=row.variant,
                condition=row.condition,
                seed=row.seed,
                taps=treatments.get((row.treatment.key(), row.scenes), ()),
            )
            for row in plan.rows
        )
        reads = ((row.variant, tap) for row in rows for tap in row.taps)
        return cls(rows=rows, findings=(*findings, *unread(reads), *unproven(trials.met())))

    def at(self, variant: str, condition: str) -> tuple[TapCount, ...]:
        """Return the taps of a variant under a condition, all seeds together; `KeyError` without
        any."""
        rows = [row for row in self.rows if (row.variant, row.condition) == (variant, condition)]
        if not rows:
            raise KeyError((variant, condition))
        return added(count for row in rows for count in row.taps)


def unread(counts: Iterable[tuple[str, TapCount]]) -> tuple[Unread, ...]:
    """Return the readers that a variant declares and that never read, in any of its treatments.

    `counts` are what the taps did in each treatment, with the name of the variant.
    """
    reads: dict[tuple[str, str, str], int] = {}
    for variant, tap in counts:
        key = (variant, tap.channel, tap.reader)
        reads[key] = reads.get(key, 0) + tap.deliveries
    return tuple(
        Unread(variant=variant, channel=channel, reader=reader)
        for (variant, channel, reader), count in reads.items()
        if count == 0
    )


def unproven(met: Iterable[tuple[str, tuple[str, ...]]]) -> tuple[Unproven, ...]:
    """Return a finding where the hashes are the same in all scenes.

    `met` are scenes of trials with the hashes that these carry.
    """
    scenes, first = set[str](), tuple[str, ...]()
    for scene, hashes in met:
        first = first or hashes
        if hashes != first:  # mostly at once: what all trials met would take much memory
            return ()
        scenes.add(scene)
    return (Unproven(scenes=len(scenes), hashes=first),) if len(scenes) > 1 else ()
