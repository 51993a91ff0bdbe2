"""Deliveries of the taps in every group of trials, and what they and the trials show of a system's
declarations."""

from collections.abc import Iterable, Mapping
from typing import Literal, Self, TypeAlias

from faultpath.core.results import Result
from faultpath.loop import TapCount, added
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

    format: Literal[1] = 1
    rows: tuple[RowDeliveries, ...] = ()
    findings: tuple[str, ...] = ()
    """Findings that a reader of the run's results has to know, a sentence or two each."""
    repeats: bool = True
    """Whether all trials that ran a second time came out the same."""

    @classmethod
    def of(
        cls,
        plan: Plan,
        treatments: Mapping[TreatmentPart, tuple[TapCount, ...]],
        trials: Trials,
        findings: tuple[str, ...],
        repeats: bool = True,
    ) -> Self:
        """Lay the counts out in the order of the plan's rows.

        To `findings` it adds what counts and outcomes show of the declarations.
        """
        rows = tuple(
            RowDeliveries(
                variant=r.variant,
                condition=r.condition,
                seed=r.seed,
                taps=treatments.get((r.treatment.key(), r.scenes), ()),
            )
            for r in plan.rows
        )
        reads = [(row.variant, tap) for row in rows for tap in row.taps]
        return cls(
            rows=rows,
            findings=(*findings, *unread(reads), *unproven(trials.met())),
            repeats=repeats,
        )

    def at(self, variant: str, condition: str) -> tuple[TapCount, ...]:
        """Return the taps of a variant under a condition, all seeds together; `KeyError` without
        any."""
        rows = [row for row in self.rows if (row.variant, row.condition) == (variant, condition)]
        if not rows:
            raise KeyError((variant, condition))
        return added(count for row in rows for count in row.taps)


def unread(counts: Iterable[tuple[str, TapCount]]) -> tuple[str, ...]:
    """Name the readers that a variant declares and that never read, in any of its treatments.

    `counts` are what the taps did in each treatment, with the name of the variant.
    """
    reads: dict[tuple[str, str, str], int] = {}
    for variant, tap in counts:
        key = (variant, tap.channel, tap.reader)
        reads[key] = reads.get(key, 0) + tap.deliveries
    return tuple(
        f"Variant '{variant}' declares that {reader} reads '{channel}', but it never did: take "
        "it out of the variant's readers, or deliver the channel to it."
        for (variant, channel, reader), count in reads.items()
        if count == 0
    )


def unproven(met: Iterable[tuple[str, tuple[str, ...]]]) -> tuple[str, ...]:
    """Say so where the hashes are the same in all scenes, and so prove nothing about the pairs.

    `met` are scenes of trials with the hashes that these carry.
    """
    by_scene = set(met)
    scenes, hashes = ({of[place] for of in by_scene} for place in (0, 1))
    if len(scenes) < 2 or len(hashes) > 1:
        return ()
    return (
        f"All {len(scenes)} scenes carry the same hashes of initial state, disturbance and planner "
        f"noise ({', '.join(map(repr, hashes.pop()))}), so nothing proves that two trials met the "
        "same conditions: hash what each scene begins with and meets.",
    )
