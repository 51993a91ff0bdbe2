"""From the trials of a scan to its result."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from faultpath.analyses.model import CORRECT, invalid_by
from faultpath.analyses.scan.errors import Scanned, label
from faultpath.analyses.scan.model import (
    FirstStage,
    ScanError,
    ScanFacts,
    ScannedPair,
    ScannedVersion,
    ScanResult,
    SecondStage,
    Together,
)
from faultpath.analyses.scan.sources import Ranking
from faultpath.core.errors import UserError
from faultpath.run.deliveries import Deliveries
from faultpath.run.findings import Unpaired
from faultpath.run.pairing import Group, pair
from faultpath.run.question import ScanQuestion
from faultpath.run.trials import Trials
from faultpath.stats.cancelling import LEVEL, MOST, StageOne, cancelling, stage_one
from faultpath.stats.inputs import Floats

Successes: TypeAlias = Mapping[str, Floats]
"""Success of a variant [scenes], a mean over the seeds, by condition; not a number where a trial
has no outcome."""


def going_on(
    question: ScanQuestion, errors: Sequence[ScanError], trials: Trials, scenes: Sequence[str]
) -> tuple[int, ...]:
    """Return the errors that hurt in a variant and go on, the worst first."""
    worst: dict[int, float] = {}
    for stage in first_stages(question, errors, trials, scenes):
        for error in stage.hurting:
            worst[error] = max(float(stage.losses[error]), worst.get(error, 0.0))
    return tuple(sorted(worst, key=lambda error: (-worst[error], error))[:MOST])


def hurting(
    question: ScanQuestion, errors: Sequence[ScanError], trials: Trials, scenes: Sequence[str]
) -> set[tuple[str, int]]:
    """Return the sources and signs of which an error is seen to cost success in some variant."""
    return {
        (error.source, error.sign)
        for stage in first_stages(question, errors, trials, scenes)
        for error, p_value in zip(errors, stage.p_values.tolist(), strict=True)
        if p_value < LEVEL
    }


def first_stages(
    question: ScanQuestion, errors: Sequence[ScanError], trials: Trials, scenes: Sequence[str]
) -> Iterable[StageOne]:
    """Yield how the errors did alone in the first stage, by variant."""
    for variant in question.variants:
        success, _ = successes(trials, variant, [label([error]) for error in errors], scenes)
        yield stage_one(success[CORRECT], np.stack([success[label([e])] for e in errors]))


def successes(
    trials: Trials, variant: str, conditions: Iterable[str], scenes: Sequence[str]
) -> tuple[Successes, tuple[Unpaired, ...]]:
    """Return success without an error and under some conditions, in some scenes, and the trials
    that met other conditions than those without an error, which are left out."""
    chosen = set(scenes)
    inside = np.array([scene.id in chosen for scene in trials.scenes], dtype=np.bool_)
    kept = tuple(scene for scene in trials.scenes if scene.id in chosen)
    part = replace(trials, scenes=kept, index=trials.index[..., inside])
    success: dict[str, Floats] = {}
    unpaired: list[Unpaired] = []
    for condition in (CORRECT, *conditions):
        pairs = pair(part, Group(variant, condition), Group(variant, CORRECT))
        unpaired += pairs.unpaired
        means = pairs.success[0].mean(axis=1)
        success[condition] = np.where(pairs.void.any(axis=0), np.nan, means)
        if np.isnan(success[condition]).all():
            rows = part.rows(variant, condition).ravel().tolist()
            why = next((part.errors[row] for row in rows if row in part.errors), "unlike pairs")
            raise UserError(
                f"no trial of {variant} under {condition} is left, because all failed ({why}): fix "
                "what made them fail, or give a smaller error with --fault."
            )
    return success, tuple(unpaired)


def concluded(
    question: ScanQuestion,
    facts: ScanFacts,
    ranking: Ranking,
    scanned: Scanned,
    trials: Trials,
    deliveries: Deliveries,
) -> ScanResult:
    """Return the result of a scan; `UserError` where no trial of a condition is left."""
    unpaired: list[Unpaired] = []
    versions = [_version(name, scanned, trials, unpaired) for name in question.variants]
    findings = (*Unpaired.first_of(unpaired), *deliveries.findings)
    invalid = invalid_by(findings)
    if invalid:
        versions = [_without_claims(version) for version in versions]
    return ScanResult(
        question=question,
        facts=facts,
        ranking=ranking,
        errors=scanned.errors,
        chosen=scanned.chosen,
        scenes=(len(scanned.first), len(scanned.second)),
        trials=len(trials),
        versions=tuple(versions),
        invalid=invalid,
        failed=int(trials.failed.sum()),
        findings=findings,
    )


def _version(
    variant: str, scanned: Scanned, trials: Trials, unpaired: list[Unpaired]
) -> ScannedVersion:
    names = [label([error]) for error in scanned.tried]
    success, unlike = successes(trials, variant, names, scanned.first)
    unpaired += unlike
    acted = [_acted(trials, variant, name) for name in names]
    first = _first_stage(scanned.tried, success, acted)
    conditions = {at: label([scanned.errors[place] for place in at]) for at in scanned.conditions}
    if len(conditions) < 2:
        return ScannedVersion(variant=variant, first=first, singles=(), pairs=(), together=())
    names = [name for name in conditions.values() if name]
    success, unlike = successes(trials, variant, names, scanned.second)
    unpaired += unlike
    by_errors = {places: success[name or CORRECT] for places, name in conditions.items()}
    singles, pairs = _second_stage(scanned, by_errors)
    return ScannedVersion(
        variant=variant,
        first=first,
        singles=singles,
        pairs=pairs,
        together=tuple(_together(scanned.errors, places, by_errors) for places in scanned.together),
    )


def _acted(trials: Trials, variant: str, condition: str) -> bool:
    rows = trials.rows(variant, condition).ravel()
    return bool(trials.steps[1, rows[rows >= 0]].any())


def _first_stage(
    tried: Sequence[ScanError], success: Successes, acted: Sequence[bool]
) -> tuple[FirstStage, ...]:
    none = success[CORRECT]
    alone = [success[label([error])] for error in tried]
    stage = stage_one(none, np.stack(alone))
    tested = cancelling(none, dict(enumerate(alone)), {}, set()).singles
    return tuple(
        FirstStage(
            error=error,
            none=100.0 * float(np.nanmean(none)),
            alone=100.0 * float(np.nanmean(values)),
            loss=float(stage.losses[place]),
            p_value=float(stage.p_values[place]),
            helps_p=tested[place].helps_p,
            acted=acted[place],
        )
        for place, (error, values) in enumerate(zip(tried, alone, strict=True))
    )


def _second_stage(
    scanned: Scanned, success: Mapping[tuple[int, ...], Floats]
) -> tuple[tuple[SecondStage, ...], tuple[ScannedPair, ...]]:
    """Return what the errors did alone and in pairs, by the decisions of a scan."""
    if not scanned.singles:
        return (), ()
    source = [error.source for error in scanned.errors]
    result = cancelling(
        success[()],
        {error: success[error,] for error in scanned.singles},
        {errors: success[errors] for errors in scanned.pairs},
        {(a, b) for a, b in scanned.pairs if source[a] == source[b]},
    )
    return (
        tuple(SecondStage(error=at, **single._asdict()) for at, single in result.singles.items()),
        tuple(ScannedPair(errors=at, **pair._asdict()) for at, pair in result.pairs.items()),
    )


def _together(
    errors: Sequence[ScanError], places: tuple[int, ...], success: Mapping[tuple[int, ...], Floats]
) -> Together:
    one = errors[places[0]]
    readers = {e.reader for e in errors if (e.source, e.sign) == (one.source, one.sign)}
    left_out = readers - {errors[place].reader for place in places}
    none, values = success[()], success[places]
    known = ~np.isnan(none - values)
    return Together(
        errors=places,
        left_out=min(left_out, default=""),
        none=100.0 * float(none[known].mean()),
        success=100.0 * float(values[known].mean()),
        scenes=int(known.sum()),
    )


def _without_claims(version: ScannedVersion) -> ScannedVersion:
    """Return the numbers of a version without the kinds that would follow from them."""
    none = {"kind": None, "covering": None}
    return version.model_copy(
        update={
            "singles": tuple(s.model_copy(update={"kind": None}) for s in version.singles),
            "pairs": tuple(pair.model_copy(update=none) for pair in version.pairs),
        }
    )
