"""Trials that other tools ran, as facts, conditions and trials of an audit."""

import hashlib
import json
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from faultpath.analyses.decide import primary_condition
from faultpath.analyses.facts import ComparisonFacts
from faultpath.analyses.model import AS_RUN, CORRECT, SHARED, Condition, title_of, where
from faultpath.core.errors import UserError
from faultpath.core.text import listed, unknown
from faultpath.run.deliveries import unproven
from faultpath.run.findings import ExtraTrials, Finding, MissingTrials, NoneFailed, SeveralTasks
from faultpath.run.question import FEWEST_TRAININGS
from faultpath.run.received.question import JudgeQuestion
from faultpath.run.received.trial import NO_OUTCOME, Received
from faultpath.run.store.tables import FIXED
from faultpath.run.trials import Trial, Trials
from faultpath.system.outcome import Metric, Outcome, Status, failed_outcome

Key = tuple[str, str]
"""A trial within its variant and condition: its scene or task, and its label there."""
Address = tuple[str, str, Key]
"""Variant, condition and key."""


@dataclass(frozen=True)
class Units:
    """Scenes or tasks, each with the labels of its trials."""

    labels: Mapping[str, Collection[str]]
    """All of them."""
    compared: Mapping[str, Sequence[str]]
    """Those that are compared, at most as many as seeds, in order."""
    seeds: tuple[int, ...]


@dataclass(frozen=True)
class PairedResults:
    """Arguments of `decide`."""

    question: JudgeQuestion
    facts: ComparisonFacts
    conditions: tuple[Condition, ...]
    trials: Trials
    findings: tuple[Finding, ...]


def pair_results(rows: Sequence[Received], request: JudgeQuestion) -> PairedResults:
    """Pair the trials of two variants by what names them: task, scene, seed and condition.

    A trial that one variant has and the other lacks counts as failed there, and is named.
    Raises `UserError` where rows do not fit together, or not to the question.
    """
    if request.baseline == request.repair:
        raise UserError(f"baseline and repair are both '{request.repair}': name two versions.")
    for name in (request.baseline, request.repair):
        if name not in (versions := {row.variant for row in rows}):
            raise UserError(f"the results: {unknown('version', name, versions)}.")
    rows = [row for row in rows if row.variant in (request.baseline, request.repair)]
    names = _condition_names({row.condition for row in rows}, request)
    if request.cluster == "task" and not all(row.task for row in rows):
        raise UserError("not every trial names its task: give --column task=NAME.")
    received = _by_address(rows, names, request)
    ordered = sorted(set(names.values()), key=lambda name: (name == SHARED, name != CORRECT, name))
    _check_paired(received, ordered, request)

    units = _units(received, request)
    hashed = _hashed(rows)
    trials, missing = _table(received, ordered, units, request, hashed)
    conditions = tuple(
        Condition(name=name, title=title_of(name), readers=(), baseline_readers=())
        for name in ordered
    )
    keys = {unit: sorted(members) for unit, members in units.labels.items()}
    crashed = any(row.status is Status.CRASH for row in rows)
    facts = ComparisonFacts(
        system="results of other tools",
        library="results",
        library_hash=hashlib.sha256(json.dumps(keys, sort_keys=True).encode()).hexdigest()[:16],
        n_scenes=len(units.labels),
        seeds=units.seeds,
        primary=primary_condition(request.primary or "", conditions),
        trained=request.generalise == "models",
        ends={} if crashed else {Status.TIMEOUT.value: "no success"},
        metrics=_metrics(request),
        pairing="hashes" if hashed else "keys",
        unit=request.cluster,
    )
    longer = [unit for unit, members in units.labels.items() if len(members) > len(units.seeds)]
    tasks = len({row.task for row in rows})
    findings = tuple(_findings(trials, missing, longer, tasks, hashed, request))
    question = request.model_copy(update={"folder": None})
    return PairedResults(question, facts, conditions, trials, findings)


def _condition_names(conditions: Collection[str], question: JudgeQuestion) -> dict[str, str]:
    """Return our name of each condition; `UserError` without one that is nominal."""
    for name in filter(None, (question.nominal, question.shared)):
        if name not in conditions:
            raise UserError(
                f"the results have no such condition: {unknown('condition', name, conditions)}."
            )
    if conditions == {""}:
        return {"": AS_RUN}
    nominal = {question.nominal} if question.nominal else {"", "nominal", "correct"}
    shared = {question.shared} if question.shared else {"shared"}

    def ours(condition: str) -> str:
        if condition in nominal:
            return CORRECT
        if condition in shared:
            return SHARED
        return "one module" if condition == "isolated" else condition.removeprefix("isolated:")

    names = {condition: ours(condition) for condition in sorted(conditions)}
    if CORRECT not in names.values():
        raise UserError(
            f"no condition is nominal ({listed(conditions)}): say with --nominal which one is "
            "without the fault."
        )
    if len(set(names.values())) < len(names):
        raise UserError(
            f"two of the conditions mean the same ({listed(conditions)}): say with --nominal and "
            "--shared which is which."
        )
    return names


def _by_address(
    rows: Iterable[Received], names: Mapping[str, str], question: JudgeQuestion
) -> dict[Address, Received]:
    trials: dict[Address, Received] = {}
    for row in rows:
        scene = f"{row.task}/{row.scene}" if row.task else row.scene
        key = (scene, row.seed)
        if question.cluster == "task":
            key = (row.task, f"{row.scene}, seed {row.seed}" if row.seed else row.scene)
        address = (row.variant, names[row.condition], key)
        if (before := trials.setdefault(address, row)) is not row:
            seed = f", seed {row.seed}" if row.seed else ""
            columns = "--column seed=NAME"
            if not any(names):  # of no trial the condition is known
                columns = f"--column condition=NAME or {columns}"
            raise UserError(
                f"{row.where} and {before.where} are the same trial (version {row.variant}, scene "
                f"{scene}{seed}): give each once, or name the column that tells them apart, as in "
                f"{columns}."
            )
    return trials


def _check_paired(
    trials: Collection[Address], conditions: Sequence[str], question: JudgeQuestion
) -> None:
    """Raise `UserError` for a condition without a trial that both variants have."""
    for condition in conditions:
        ones, twos = keys = [
            sorted(key for variant, at, key in trials if (variant, at) == (name, condition))
            for name in (question.baseline, question.repair)
        ]
        for name, known in zip((question.baseline, question.repair), keys, strict=True):
            if not known:
                raise UserError(
                    f"'{name}' has no trial {where(condition)}: give both versions under each "
                    "condition."
                )
        if not set(ones) & set(twos):
            first, second = (", seed ".join(filter(None, known[0])) for known in keys)
            raise UserError(
                f"no trial of '{question.baseline}' has its pair in '{question.repair}' "
                f"{where(condition)} (the first are scene {first} and scene {second}): name the "
                "columns that say what belongs together, as in --column scene=NAME."
            )


def _hashed(rows: Sequence[Received]) -> bool:
    """Return whether trials carry hashes of what they began with; `UserError` if only some do."""
    ended = [row for row in rows if row.status is not Status.FAILED]
    bare = [row for row in ended if not row.initial]
    if bare and len(bare) < len(ended):
        raise UserError(
            f"{bare[0].where} has no hash of its initial state, and other trials have one: fill "
            "the column, or take it out."
        )
    return bool(ended) and not bare


def _units(trials: Iterable[Address], request: JudgeQuestion) -> Units:
    """Return the trials compared of each scene or task; `UserError` where the question is of newly
    trained models and trials have no seeds."""
    labels: dict[str, dict[str, None]] = {}
    for _, _, (unit, label) in trials:
        labels.setdefault(unit, {})[label] = None
    often = Counter(label for members in labels.values() for label in members)
    sizes = Counter(len(members) for members in labels.values())
    # As many trials of each as leave the most of all, and first those that most scenes have.
    most = max(
        sorted(sizes),
        key=lambda size: size * sum(units for other, units in sizes.items() if other >= size),
    )
    compared = {
        unit: sorted(sorted(members, key=lambda x: (-often[x], _in_order(x)))[:most], key=_in_order)
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
    if alike and all(label.isdecimal() and len(label) < 19 for label in min(different)):
        seeds = tuple(sorted(map(int, min(different))))
    return Units(labels, compared, seeds)


def _table(
    trials: Mapping[Address, Received],
    conditions: Sequence[str],
    units: Units,
    request: JudgeQuestion,
    hashed: bool,
) -> tuple[Trials, dict[tuple[str, str], list[Key]]]:
    """Return a row for each trial that should be there, and by variant and condition the keys of
    those that are not."""
    rows: list[Trial] = []
    missing: dict[tuple[str, str], list[Key]] = {}
    tasks = {unit: row.task for (_, _, (unit, _)), row in trials.items()}
    ordered = sorted(units.labels, key=_in_order)
    for condition, variant in product(conditions, (request.baseline, request.repair)):
        for (at, seed), (index, unit) in product(enumerate(units.seeds), enumerate(ordered)):
            labels = units.compared[unit][at : at + 1]
            row = trials.get((variant, condition, (unit, labels[0]))) if labels else None
            if row is None:
                missing.setdefault((variant, condition), []).append((unit, "".join(labels)))
            topology = tasks[unit] if request.cluster == "scene" else ""
            outcome = _outcome(unit, row, hashed)
            rows.append(Trial(variant, condition, seed, index, topology, outcome))
    place = {condition: place for place, condition in enumerate(conditions)}
    rows.sort(key=lambda row: (place[row.condition], row.variant, row.seed, row.scene_index))
    return Trials.of(rows), missing


def _outcome(scene: str, row: Received | None, hashed: bool) -> Outcome:
    if row is None:
        return failed_outcome(scene, "it is not among the results")
    if row.status is Status.FAILED:
        return failed_outcome(scene, row.error)
    initial = row.initial if hashed else "none"
    return Outcome(scene, row.status, row.time_s, initial, "none", "none", row.metrics)


def _in_order(label: str) -> tuple[bool, int, str]:
    return (not label.isdecimal(), int(label) if label.isdecimal() else 0, label)


def _metrics(question: JudgeQuestion) -> dict[str, Metric]:
    metrics: dict[str, Metric] = {}
    for name, _, better in (text.partition(":") for text in question.metrics):
        if not re.fullmatch("[a-z][a-z0-9_]*", name) or name in FIXED:
            raise UserError(
                f"--metric {name} cannot be the name of a metric: rename the column to small "
                "letters, digits and underscores, and not to what every trial has."
            )
        if better not in ("", "more", "less"):
            raise UserError(f"--metric {name}:{better} is neither less nor more: give one of them.")
        metrics[name] = Metric(unit="1", better="less" if better == "less" else "more")
    return metrics


def _findings(
    trials: Trials,
    missing: Mapping[tuple[str, str], Sequence[Key]],
    longer: Sequence[str],
    tasks: int,
    hashed: bool,
    question: JudgeQuestion,
) -> Iterator[Finding]:
    for (variant, condition), keys in missing.items():
        first, trial = keys[0]
        yield MissingTrials(
            variant=variant,
            condition=condition,
            trials=len(keys),
            unit=question.cluster,
            first=first,
            trial=trial,
        )
    if longer:
        yield ExtraTrials(units=len(longer), unit=question.cluster, first=longer[0])
    if question.cluster == "scene" and tasks > 1:
        yield SeveralTasks(tasks=tasks)
    if hashed:
        yield from unproven(trials.met())
    succeeded = trials.has(Status.SUCCESS)
    if NO_OUTCOME in trials.errors.values() and (succeeded | trials.failed).all():
        yield NoneFailed()
