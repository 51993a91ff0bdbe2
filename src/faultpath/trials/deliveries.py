"""What the taps did in every arm of a study, from their receipts."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Self

from faultpath.core.results import Result
from faultpath.loop import TapCount, added
from faultpath.trials.arm import Study
from faultpath.trials.outcome import Outcome
from faultpath.trials.table import OutcomeTable


class RowDeliveries(Result):
    """The taps of one row of a study."""

    variant: str
    path: str
    seed: int
    taps: tuple[TapCount, ...]
    """In the order of the interface; empty where every trial failed."""


class Deliveries(Result):
    """The taps of a study, row by row; written as `deliveries.json`."""

    format: int = 1
    rows: tuple[RowDeliveries, ...] = ()
    findings: tuple[str, ...] = ()
    """What the run found that a reader of its results has to know, a sentence or two each."""

    @classmethod
    def of(
        cls,
        study: Study,
        arms: Mapping[str, tuple[TapCount, ...]],
        table: OutcomeTable,
        findings: tuple[str, ...],
    ) -> Self:
        """Lay the counts, by arm key, out in the order of the study's rows.

        To `findings` it adds what counts and outcomes show of the declarations.
        """
        rows = tuple(
            RowDeliveries(
                variant=r.variant, path=r.path, seed=r.seed, taps=arms.get(r.arm.key(), ())
            )
            for r in study.rows
        )
        reads = [(row.variant, tap) for row in rows for tap in row.taps]
        return cls(
            rows=rows,
            findings=(*findings, *unread(reads), *unproven([row.outcome for row in table.rows])),
        )

    def at(self, variant: str, path: str) -> tuple[TapCount, ...]:
        """Return the taps of a variant on a path, all seeds together; `KeyError` without any."""
        rows = [row for row in self.rows if (row.variant, row.path) == (variant, path)]
        if not rows:
            raise KeyError((variant, path))
        return added(count for row in rows for count in row.taps)


def unread(counts: Iterable[tuple[str, TapCount]]) -> tuple[str, ...]:
    """Name the consumers that a variant declares and that never read, in any of its arms.

    `counts` are what the taps did in each arm, with the name of the variant.
    """
    reads: dict[tuple[str, str, str], int] = {}
    for variant, tap in counts:
        key = (variant, tap.channel, tap.consumer)
        reads[key] = reads.get(key, 0) + tap.deliveries
    return tuple(
        f"Variant '{variant}' declares that {consumer} reads '{channel}', but it never did: take "
        "it out of the variant's consumers, or deliver the channel to it."
        for (variant, channel, consumer), count in reads.items()
        if count == 0
    )


def unproven(outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    """Say so where the hashes are the same in all scenes, and so prove nothing about the pairs."""
    sound = [each for each in outcomes if not each.failed]
    scenes = {each.scene for each in sound}
    met = {(each.initial_hash, each.disturbance_hash, each.planner_noise_hash) for each in sound}
    if len(scenes) < 2 or len(met) > 1:
        return ()
    return (
        f"All {len(scenes)} scenes carry the same hashes of initial state, disturbance and planner "
        f"noise ({', '.join(map(repr, met.pop()))}), so nothing proves that two trials met the "
        "same conditions: hash what each scene begins with and meets.",
    )
