"""Tables of a study: the outcome table, one row a scene, variant, path and seed; and what
the taps did in every arm, from their receipts."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, Self

from faultpath.core.errors import UserError
from faultpath.core.results import Result
from faultpath.loop import TapCount, added
from faultpath.trials.arm import Row, Study
from faultpath.trials.declared import Library, SceneRef
from faultpath.trials.outcome import Outcome


@dataclass(frozen=True)
class TrialRow:
    """One trial and where it stands in the study."""

    variant: str
    path: str
    seed: int
    scene_index: int
    topology: str
    outcome: Outcome


@dataclass(frozen=True)
class OutcomeTable:
    """Every trial of a study: the rows of the study in order, in each the scenes by index."""

    rows: tuple[TrialRow, ...]

    @cached_property
    def _arms(self) -> Mapping[tuple[str, str, int], tuple[TrialRow, ...]]:
        arms: dict[tuple[str, str, int], list[TrialRow]] = {}
        for row in self.rows:
            arms.setdefault((row.variant, row.path, row.seed), []).append(row)
        return {address: tuple(rows) for address, rows in arms.items()}

    def arm(self, variant: str, path: str, seed: int) -> tuple[TrialRow, ...]:
        """Return the trials of one arm by scene index; `KeyError` when the table has none."""
        return self._arms[variant, path, seed]

    def seeds(self, variant: str, path: str) -> tuple[int, ...]:
        """Return the seeds of a variant on a path, in the order of the study."""
        return tuple(s for (v, p, s) in self._arms if (v, p) == (variant, path))

    def failed(self) -> tuple[TrialRow, ...]:
        """Return the trials in which the program raised an error or died."""
        return tuple(row for row in self.rows if row.outcome.failed)


def selected(study: Study, library: Library) -> tuple[SceneRef, ...]:
    """Return the scenes of a study by index; `UserError` for an unknown, repeated or absent one."""
    known = {scene.id: scene for scene in library.scenes}
    unknown = [scene for scene in study.scenes if scene not in known]
    if unknown:
        raise UserError(
            f"library {library.name!r} has no scene {unknown[0]!r}: choose from its "
            f"{len(known)} scenes, the first of which is {next(iter(known), 'none')!r}"
        )
    if not study.scenes:
        raise UserError(f"study {study.name!r} selects no scene: choose at least one")
    if len(set(study.scenes)) < len(study.scenes):
        twice = next(s for s in study.scenes if study.scenes.count(s) > 1)
        raise UserError(f"study {study.name!r} selects scene {twice!r} twice: select it once")
    return tuple(sorted((known[scene] for scene in study.scenes), key=lambda scene: scene.index))


def check_rows(rows: Iterable[Row], variants: Iterable[str]) -> None:
    """Raise `UserError` for a row without a known variant, or for two rows at one address."""
    known = tuple(variants)
    addresses: set[tuple[str, str, int]] = set()
    for row in rows:
        if row.arm.variant not in known:
            raise UserError(
                f"the system has no variant {row.arm.variant!r}: choose from {', '.join(known)}"
            )
        address = (row.variant, row.path, row.seed)
        if address in addresses:
            raise UserError(
                f"two rows of the study are both called variant {row.variant!r}, path "
                f"{row.path!r}, seed {row.seed}: give them different names"
            )
        addresses.add(address)


def assemble(
    study: Study, library: Library, outcomes: Mapping[tuple[str, str], Outcome]
) -> OutcomeTable:
    """Lay the outcomes, by arm key and scene, out in the order of the study's rows."""
    scenes, rows = selected(study, library), list[TrialRow]()
    for row in study.rows:
        where, key = (row.variant, row.path, row.seed), row.arm.key()
        rows += [TrialRow(*where, s.index, s.topology, outcomes[key, s.id]) for s in scenes]
    return OutcomeTable(tuple(rows))


class RowDeliveries(Result):
    """The taps of one row of a study."""

    variant: str
    path: str
    seed: int
    taps: tuple[TapCount, ...]
    """In the order of the interface; empty where every trial failed."""


class Deliveries(Result):
    """The taps of a study, row by row; written as `deliveries.json`."""

    format: Literal[1] = 1
    rows: tuple[RowDeliveries, ...] = ()
    findings: tuple[str, ...] = ()
    """Findings that a reader of the run's results has to know, a sentence or two each."""
    repeats: bool = True
    """Whether all trials that ran a second time came out the same."""

    @classmethod
    def of(
        cls,
        study: Study,
        arms: Mapping[str, tuple[TapCount, ...]],
        table: OutcomeTable,
        findings: tuple[str, ...],
        repeats: bool = True,
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
            repeats=repeats,
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
    sound = [outcome for outcome in outcomes if not outcome.failed]
    scenes = {outcome.scene for outcome in sound}
    met = {
        (outcome.initial_hash, outcome.disturbance_hash, outcome.planner_noise_hash)
        for outcome in sound
    }
    if len(scenes) < 2 or len(met) > 1:
        return ()
    return (
        f"All {len(scenes)} scenes carry the same hashes of initial state, disturbance and planner "
        f"noise ({', '.join(map(repr, met.pop()))}), so nothing proves that two trials met the "
        "same conditions: hash what each scene begins with and meets.",
    )
