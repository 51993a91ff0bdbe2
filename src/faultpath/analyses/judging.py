"""Trials that other tools ran, as facts, conditions and trials of an audit."""

import hashlib
import json
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from faultpath.analyses.decide import primary_condition
from faultpath.analyses.facts import ComparisonFacts
from faultpath.analyses.judging_table import Cell, Key, table_of, units_of
from faultpath.analyses.model import AS_RUN, CORRECT, SHARED, Condition, title_of, where
from faultpath.core.errors import UserError
from faultpath.core.text import listed, unknown
from faultpath.run.deliveries import unproven
from faultpath.run.findings import ExtraTrials, Finding, MissingTrials, NoneFailed, SeveralTasks
from faultpath.run.received.question import JudgeQuestion
from faultpath.run.received.results import NO_OUTCOME, Received
from faultpath.run.store.tables import FIXED
from faultpath.run.trials import Trials
from faultpath.system.outcome import Metric, Status


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
    if request.cluster == "task" and request.generalise == "models":
        raise UserError(
            "--cluster task takes scenes and seeds alike as trials of a task, so it does not know "
            "which trainings there are: leave it or --generalise models out."
        )
    received = _by_key(rows, names, request)
    ordered = sorted(set(names.values()), key=lambda name: (name == SHARED, name != CORRECT, name))
    _check_paired(received, ordered, request)

    units = units_of(received, request)
    hashed = _hashed(rows)
    trials, missing = table_of(received, ordered, units, request, hashed)
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
    if question.shared in nominal - {""}:
        raise UserError(
            f"'{question.shared}' is the nominal condition: name another with --shared."
        )

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
    for condition, name in names.items():
        if name in ("", AS_RUN) or (name == SHARED and condition not in shared):
            raise UserError(
                f"condition '{condition}' does not name a module: give the name of the module that "
                "alone had the fault, or say with --nominal and --shared what the condition is."
            )
    return names


def _by_key(
    rows: Iterable[Received], names: Mapping[str, str], question: JudgeQuestion
) -> dict[Cell, dict[Key, Received]]:
    trials: dict[Cell, dict[Key, Received]] = {}
    keys: dict[Key, Key] = {}
    scenes: dict[str, tuple[str, str]] = {}
    for row in rows:
        scene = f"{row.task}/{row.scene}" if row.task else row.scene
        if (other := scenes.setdefault(scene, (row.task, row.scene))) != (row.task, row.scene):
            raise UserError(
                f"{row.where}: scene '{row.scene}' of task '{row.task}' would be called '{scene}', "
                f"as scene '{other[1]}' of task '{other[0]}': name one of them differently."
            )
        key = (scene, row.seed)
        if question.cluster == "task":
            key = (row.task, f"{row.scene}, seed {row.seed}" if row.seed else row.scene)
        key = keys.setdefault(key, key)  # one for all variants and conditions
        of_cell = trials.setdefault((row.variant, names[row.condition]), {})
        if (before := of_cell.setdefault(key, row)) is not row:
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
    trials: Mapping[Cell, Mapping[Key, Received]],
    conditions: Sequence[str],
    question: JudgeQuestion,
) -> None:
    """Raise `UserError` for a condition without a trial that both variants have."""
    for condition in conditions:
        versions = (question.baseline, question.repair)
        keys = [trials.get((name, condition), {}).keys() for name in versions]
        for name, known in zip(versions, keys, strict=True):
            if not known:
                raise UserError(
                    f"'{name}' has no trial {where(condition)}: give both versions under each "
                    "condition."
                )
        if keys[0].isdisjoint(keys[1]):
            first, second = (", seed ".join(filter(None, min(known))) for known in keys)
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
