"""From trials to the result of an audit."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from faultpath.analyses.compared import PairedTrials
from faultpath.analyses.contrasts import change_name, default_primary, effect_name
from faultpath.analyses.descriptive import cells_of, percent, secondary, untested_conditions
from faultpath.analyses.effects import Change, Effect, Missing
from faultpath.analyses.facts import ComparisonFacts, Question
from faultpath.analyses.family import TestedContrasts, family_of
from faultpath.analyses.model import (
    AS_RUN,
    CORRECT,
    SHARED,
    AuditResult,
    Condition,
    ConditionBreakEven,
    Share,
    Testing,
    invalid_by,
)
from faultpath.analyses.shares import between
from faultpath.analyses.stopping import stopped
from faultpath.core.errors import UserError
from faultpath.run.findings import Finding, Unpaired
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
    condition that has none is left out. The result carries `findings`, and pairs that met different
    conditions. Where there are such, or trials did not repeat, nothing is significant.
    `UserError` when no pair is left under any condition, for a primary
    condition that the audit does not have, and where newly trained models are asked for and too few
    trainings differ.
    """
    primary = primary_condition(question.primary or "", conditions)
    facts = facts.model_copy(update={"primary": primary})
    cells = cells_of(question, conditions, trials)
    # Whether a fault acted is told by receipts, and other tools' results have none.
    untested = () if facts.judged else untested_conditions(conditions, cells)
    comparison, family = family_of(question, facts, conditions, trials, untested)
    # A result that is decided anew has the first already.
    findings = tuple(dict.fromkeys((*Unpaired.first_of(comparison.unpaired), *findings)))
    invalid = invalid_by(findings)
    if invalid:
        family = family.without_claims()
    models = question.generalise == "models"
    effects = {
        condition: _effect(facts, condition, comparison, family, models)
        for condition in comparison.success
    }

    def even(ends: Sequence[tuple[str, str]], over: Share) -> tuple[ConditionBreakEven, ...]:
        pairs = ((effects[none], effects[every]) for none, every in ends)
        results = (between(*pair, comparison, family, over) for pair in pairs)
        return tuple(result for result in results if result)

    faulted = [condition for condition in effects if condition not in (CORRECT, AS_RUN, *untested)]
    from_none = [(CORRECT, condition) for condition in faulted] if CORRECT in effects else []
    from_one = [(condition, SHARED) for condition in family.changes]
    state = stopped(question, facts, family, trials)
    first = next(iter(family.effects.values()))
    return AuditResult(
        question=question,
        facts=facts,
        conditions=tuple(
            condition.model_copy(update={"acted": condition.name not in untested})
            for condition in conditions
        ),
        cells=cells,
        effects=tuple(effects.values()),
        changes=tuple(_change(condition, family) for condition in family.changes),
        secondary=tuple(
            secondary(condition, comparison.pairs[condition], question, facts)
            for condition in effects
        ),
        break_evens=(*even(from_none, "frequency"), *even(from_one, "beta")),
        scenes=max(effect.scenes for effect in effects.values()),
        invalid=invalid,
        testing=Testing(
            hypotheses=family.hypotheses,
            scenes_needed=family.scenes_needed,
            intervals=first.estimate().method,
        ),
        stopped=state and state.model_copy(update={"small": ()} if invalid else {}),
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
    facts: ComparisonFacts,
    condition: str,
    comparison: PairedTrials,
    family: TestedContrasts,
    models: bool,
) -> Effect:
    repair, baseline = comparison.success[condition]
    effect, pairs = family.effects[condition], comparison.pairs[condition]
    assert effect.test is not None
    assert effect.pairs is not None
    assert effect.won is not None
    unpaired = np.isnan(repair - baseline)
    rates = [percent(np.where(unpaired, np.nan, part)) for part in (baseline, repair)]
    void, missing = int(pairs.void.sum()), None
    if condition in family.fills:
        against, favour = family.fills[condition]
        repair_failed, baseline_failed = (
            int(failed.sum()) for failed in pairs.ended(Status.FAILED)
        )
        missing = Missing(
            void=void,
            repair=repair_failed,
            baseline=baseline_failed,
            against_pp=against.value,
            favour_pp=favour.value,
            uneven=condition in family.uneven,
            unsettled=effect_name(condition) in family.unsettled,
            repairs=family.repairs.get(condition),
        )
    elif void:
        missing = Missing(void=void)
    # None is known for newly trained models, whose spread a few seeds do not give, and of an audit
    # that stops where it has decided.
    level, least = effect.test.critical_p, None
    if level and not models and facts.order is None:
        least = detectable(effect.pairs, graded=True, alpha=level, on_top=True)
    return Effect(
        condition=condition,
        **_difference(effect),
        won=effect.won,
        ahead=effect.ahead,
        rates=(rates[0], rates[1]),
        missing=missing,
        least_pp=least,
    )


def _change(condition: str, family: TestedContrasts) -> Change:
    contrast = family.changes[condition]
    return Change(
        isolated=condition,
        **_difference(contrast),
        unsettled=change_name(condition) in family.unsettled,
        turn=family.turns[condition],
    )


def _difference(contrast: Contrast) -> dict[str, Any]:
    """Return the fields that an effect and a change share."""
    assert contrast.test is not None
    low, high = contrast.interval or (None, None)
    return {
        "value": contrast.value,
        "low": low,
        "high": high,
        "per_seed": contrast.per_seed,
        "scenes": contrast.n_scenes,
        "test": contrast.test.name,
        "p_value": contrast.test.p_value,
        "corrected_p": contrast.test.corrected_p,
        "sign": contrast.test.sign,
    }
