"""The table of judged trials: which of a scene or task are compared, and which are missing."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, product

from faultpath.core.errors import UserError
from faultpath.run.question import FEWEST_TRAININGS
from faultpath.run.received.question import JudgeQuestion
from faultpath.run.received.results import Received
from faultpath.run.trials import Trial, Trials
from faultpath.system.outcome import Outcome, Status, failed_outcome

Key = tuple[str, str]
"""A trial within its variant and condition: its scene or task, and its label there."""
Cell = tuple[str, str]
"""Variant and condition."""


@dataclass(frozen=True)
class Units:
    """Scenes or tasks, each with the labels of its trials."""

    labels: Mapping[str, Collection[str]]
    """All of them."""
    compared: Mapping[str, Sequence[str]]
    """Those that are compared, at most as many as seeds, in order."""
    seeds: tuple[int, ...]


def units_of(trials: Mapping[Cell, Iterable[Key]], request: JudgeQuestion) -> Units:
    """Return the trials compared of each scene or task; `UserError` where the question is of newly
    trained models and trials have no seeds."""
    labels: dict[str, dict[str, None]] = {}
    for unit, label in chain.from_iterable(trials.values()):
        labels.setdefault(unit, {})[label] = None
    often = Counter(label for members in labels.values() for label in members)
    sizes = Counter(len(members) for members in labels.values())
    # As many trials of each as leave the most of all, and first those that most scenes have.
    most = max(
        sorted(sizes),
        key=lambda size: size * sum(units for other, units in sizes.items() if other >= size),
    )
    compared = {
        unit: sorted(sorted(members, key=lambda x: (-often[x], in_order(x)))[:most], key=in_order)
        for unit, members in labels.items()
    }
    different = set(map(frozenset, compared.values()))
    # Seeds that are the same everywhere are seeds; others only number the trials of a scene.
    alike = len(different) == 1
    if request.generalise == "models" and (not alike or len(min(different)) < FEWEST_TRAININGS):
        raise UserError(
            f"newly trained models need {FEWEST_TRAININGS} seeds or more, the same ones in every "
            "scene: leave --generalise models out."
        )
    seeds = tuple(range(most))
    numbers = {int(label) for label in min(different) if label.isdecimal() and len(label) < 19}
    if alike and len(numbers) == most:  # `1` and `01` are two labels and one number
        seeds = tuple(sorted(numbers))
    return Units(labels, compared, seeds)


def table_of(
    trials: Mapping[Cell, Mapping[Key, Received]],
    conditions: Sequence[str],
    units: Units,
    request: JudgeQuestion,
    hashed: bool,
) -> tuple[Trials, dict[Cell, list[Key]]]:
    """Return a row for each trial that should be there, and by variant and condition the keys of
    those that are not."""
    missing: dict[Cell, list[Key]] = {}
    tasks = {unit: row.task for rows in trials.values() for (unit, _), row in rows.items()}
    ordered = sorted(units.labels, key=in_order)

    def rows() -> Iterator[Trial]:
        for condition, variant in product(conditions, sorted((request.baseline, request.repair))):
            received = trials[variant, condition]
            for (at, seed), (index, unit) in product(enumerate(units.seeds), enumerate(ordered)):
                labels = units.compared[unit][at : at + 1]
                row = received.get((unit, labels[0])) if labels else None
                if row is None:
                    missing.setdefault((variant, condition), []).append((unit, "".join(labels)))
                topology = tasks[unit] if request.cluster == "scene" else ""
                outcome = _outcome(unit, row, hashed)
                yield Trial(variant, condition, seed, index, topology, outcome)

    table = Trials.of(rows())
    cells = ((name, at) for at in conditions for name in (request.baseline, request.repair))
    return table, {cell: missing[cell] for cell in cells if cell in missing}


def _outcome(scene: str, row: Received | None, hashed: bool) -> Outcome:
    if row is None:
        return failed_outcome(scene, "it is not among the results")
    if row.status is Status.FAILED:
        return failed_outcome(scene, row.error)
    initial = row.initial if hashed else "none"
    return Outcome(scene, row.status, row.time_s, initial, "none", "none", row.metrics)


def in_order(label: str) -> tuple[bool, int, str]:
    """Return a key that sorts labels: numbers first, by value."""
    return (not label.isdecimal(), int(label) if label.isdecimal() else 0, label)
