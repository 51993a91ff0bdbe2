"""From the trials of an audit to its result, and whether a sequential audit may stop."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from faultpath.analyses.contrasts import (
    PairedTrials,
    change_name,
    default_primary,
    effect_name,
)
from faultpath.analyses.descriptive import counts_of, percent, secondary, untested_conditions
from faultpath.analyses.effects import Change, Effect, Missing
from faultpath.analyses.facts import ComparisonFacts, EarlierAnalysis, Question
from faultpath.analyses.family import TestedContrasts, family_of
from faultpath.analyses.model import AuditResult, Condition, StoppedAudit, Testing, invalid_by
from faultpath.analyses.shares import break_even_sets
from faultpath.core.errors import UserError
from faultpath.run.findings import Finding, Unpaired
from faultpath.run.pairing import Pairs
from faultpath.run.trials import Trials
from faultpath.stats.contrast import Contrast
from faultpath.stats.power import detectable
from faultpath.system.outcome import Status


def decide(
    question: Question,
    facts: ComparisonFacts,
    conditions: Sequence[Condition],
    trials: Trials,
    findings: Sequence[Finding] = (),
) -> AuditResult:
    """Return the result of an audit.

    Each effect rests on the scenes that have its trials, each change on those that both have; a
    condition without a complete pair is left out. The result holds `findings`, and pairs that met
    different conditions. Where there are such, or trials did not repeat, nothing is significant.

    `UserError` when no pair is left under any condition, for a primary condition that the audit
    does not have, and where the question is of newly trained models and too few trainings differ.
    """
    primary = primary_condition(question.primary or "", conditions)
    facts = facts.model_copy(update={"primary": primary})
    counts = counts_of(question, conditions, trials)
    # The delivery log says whether a fault acted, and other tools' results have none.
    untested = () if facts.judged else untested_conditions(conditions, counts)

    paired, tested = family_of(question, facts, conditions, trials, untested)
    # A result that is concluded anew has the first already.
    findings = tuple(dict.fromkeys((*Unpaired.first_of(paired.unpaired), *findings)))
    if invalid := invalid_by(findings):
        tested = tested.without_claims()

    effects = {name: _effect(question, facts, name, paired, tested) for name in paired.success}
    return AuditResult(
        question=question,
        facts=facts,
        conditions=tuple(conditions),
        counts=counts,
        effects=tuple(effects.values()),
        changes=tuple(_change(condition, tested) for condition in tested.changes),
        secondary=tuple(
            secondary(name, pairs, question, facts) for name, pairs in paired.pairs.items()
        ),
        break_evens=break_even_sets(effects, paired, tested, untested),
        scenes=max(effect.scenes for effect in effects.values()),
        invalid=invalid,
        testing=Testing(
            hypotheses=tested.hypotheses,
            scenes_needed=tested.scenes_needed,
            intervals=next(iter(tested.effects.values())).method,
        ),
        stopped=stopped(question, facts, tested, trials, valid=invalid is None),
        findings=findings,
    )


def primary_condition(named: str, conditions: Sequence[Condition]) -> str:
    """Return the condition of the primary contrast: as named, else the shared one, else the
    isolated.

    `UserError` for a name that the audit does not have.
    """
    names = [condition.name for condition in conditions]
    if named and named not in names:
        raise UserError(
            f"the audit has no condition '{named}' for its primary contrast: it has "
            f"{', '.join(names)}."
        )
    return default_primary(named, names)


def _effect(
    question: Question,
    facts: ComparisonFacts,
    condition: str,
    paired: PairedTrials,
    tested: TestedContrasts,
) -> Effect:
    repair, baseline = paired.success[condition]
    effect = tested.effects[condition]
    assert effect.test is not None
    assert effect.pairs is not None
    assert effect.won is not None
    incomplete = np.isnan(repair - baseline)
    rates = [percent(np.where(incomplete, np.nan, part)) for part in (baseline, repair)]
    # Not known for newly trained models, whose spread a few seeds do not give, nor for an audit
    # that stops when its effects are significant or shown to be small.
    level, least = effect.test.critical_p, None
    if level and question.generalise != "models" and facts.order is None:
        least = detectable(effect.pairs, alpha=level, on_top=True)
    return Effect(
        condition=condition,
        **_difference(effect),
        won=effect.won,
        ahead=effect.ahead,
        rates=(rates[0], rates[1]),
        missing=_missing(condition, paired.pairs[condition], tested),
        least_pp=least,
    )


def _missing(condition: str, pairs: Pairs, tested: TestedContrasts) -> Missing | None:
    """Return what is missing of a condition's pairs; `None` where all count and no trial of any
    condition is missing."""
    incomplete = int(pairs.void.sum())
    if condition not in tested.missing.bounds:
        return Missing(void=incomplete) if incomplete else None
    against, favour = tested.missing.bounds[condition]
    repair, baseline = (int(failed.sum()) for failed in pairs.ended(Status.FAILED))
    return Missing(
        void=incomplete,
        repair=repair,
        baseline=baseline,
        against_pp=against.value,
        favour_pp=favour.value,
        uneven=condition in tested.uneven,
        unsettled=effect_name(condition) in tested.missing.inconclusive,
        reruns=tested.missing.reruns.get(condition),
    )


def _change(condition: str, tested: TestedContrasts) -> Change:
    contrast = tested.changes[condition]
    return Change(
        isolated=condition,
        **_difference(contrast),
        unsettled=change_name(condition) in tested.missing.inconclusive,
        turn=tested.turns[condition],
    )


def _difference(contrast: Contrast) -> dict[str, Any]:
    """Return the fields that an effect and a change share."""
    assert contrast.test is not None
    low, high = contrast.interval or (None, None)
    return {
        "value": contrast.value,
        "low": low,
        "high": high,
        "per_seed": tuple(value for value in contrast.per_seed if not np.isnan(value)),
        "scenes": contrast.n_scenes,
        "test": contrast.test.name,
        "p_value": contrast.test.p_value,
        "corrected_p": contrast.test.corrected_p,
        "sign": contrast.test.sign,
    }


def stopped(
    question: Question,
    facts: ComparisonFacts,
    tested: TestedContrasts,
    trials: Trials,
    valid: bool = True,
) -> StoppedAudit | None:
    """Return how far a sequential audit has come with these trials; `None` for one that is not
    sequential. No difference is shown to be small by trials that are not `valid`.

    Every claim on a contrast, of who is ahead or of how little, follows from its one interval, at
    the level of its share.
    """
    if facts.order is None:
        return None
    small: list[str] = []
    for condition, effect in tested.effects.items():
        critical = effect.test.critical_p if effect.test else None
        if critical is None or effect.n_scenes < tested.scenes_needed:
            continue
        level, margin = 1.0 - critical, question.margin_pp or 0.0
        # However failed trials would have ended.
        filled = (effect, *tested.missing.bounds.get(condition, ()))
        ends = [contrast.ends(level) or (-100.0, 100.0) for contrast in filled]
        if all(-margin < low and high < margin for low, high in ends):
            small.append(condition)
    significant_or_small = {
        condition
        for condition, effect in tested.effects.items()
        if effect.sign or condition in small
    }
    required = set(tested.effects) if question.stop_when == "all-decided" else {facts.primary}
    scenes = len(trials.scenes)
    return StoppedAudit(
        scenes=scenes, reached=required <= significant_or_small, small=tuple(small) if valid else ()
    )


def stops(
    question: Question, facts: ComparisonFacts, conditions: Sequence[Condition], trials: Trials
) -> bool:
    """Return whether a sequential audit stops with these trials, in whatever order they ran."""
    untested = untested_conditions(conditions, counts_of(question, conditions, trials))
    try:
        _, tested = family_of(question, facts, conditions, trials, untested)
    except UserError:  # no pair is complete so far
        return False
    state = stopped(question, facts, tested, trials)
    return state is not None and state.reached


def with_earlier_analyses(result: AuditResult, earlier: Iterable[AuditResult]) -> AuditResult:
    """Return a result that lists other analyses of its trials.

    `earlier` are results on the same variants by the same code, with those that they list. The same
    question once more counts as none, and so does one with too few scenes for anything to be
    significant. A sequential audit allows for all analyses with the same primary contrast.
    """

    def analysis(result: AuditResult) -> EarlierAnalysis:
        question, facts = result.question, result.facts
        return EarlierAnalysis(
            scenes=None if facts.order else facts.n_scenes,
            primary=facts.primary,
            generalise="scenes" if facts.order else question.generalise,
        )

    known: list[EarlierAnalysis] = []
    for other in earlier:
        known += other.earlier if other.few else (*other.earlier, analysis(other))
    others = tuple(other for other in dict.fromkeys(known) if other != analysis(result))
    return result.model_copy(update={"earlier": others})
