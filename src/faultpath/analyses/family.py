"""The contrasts of an audit and their joint decision."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from faultpath.analyses.compared import Outcomes, PairedTrials, compared
from faultpath.analyses.contrasts import (
    Measure,
    alpha_shares,
    change_name,
    default_primary,
    effect_name,
    isolated,
)
from faultpath.analyses.facts import ComparisonFacts, Question
from faultpath.analyses.missing import (
    Decide,
    any_missing,
    filled,
    nearest_to_nothing,
    repairs_needed,
    uneven,
)
from faultpath.analyses.model import SHARED, Condition
from faultpath.core.errors import UserError
from faultpath.run.question import FEWEST_TRAININGS
from faultpath.run.trials import Trials
from faultpath.stats import betting
from faultpath.stats.contrast import Contrast, ordered_sum
from faultpath.stats.decisions import Turn, decide_family, turn, with_test
from faultpath.stats.estimate import ALPHA
from faultpath.stats.power import fewest_scenes


@dataclass(frozen=True)
class TestedContrasts:
    """Every contrast of an audit with its decision."""

    effects: Mapping[str, Contrast]
    """By condition; without a decision where nothing was tested."""
    changes: Mapping[str, Contrast]
    """Shared minus isolated, by the isolated condition."""
    turns: Mapping[str, Turn]
    hypotheses: int
    scenes_needed: int
    measure: Measure
    fills: Mapping[str, tuple[Contrast, Contrast]]
    """By condition, where trials are missing: the effect with all of them against the repair, and
    for it."""
    uneven: Collection[str]
    """Conditions on which one version failed more often than chance explains."""
    unsettled: Collection[str]
    """Contrasts, by the names of `alpha_shares`, that would be decided but for those trials."""
    repairs: Mapping[str, tuple[int, int]]
    """By condition that is unsettled: how many failed trials of the repair and of the baseline have
    to run to settle it, if they come out as the others did."""

    def without_claims(self) -> "TestedContrasts":
        """Return the family of trials on which nothing can rest: no contrast is decided."""

        def undecided(contrasts: Mapping[str, Contrast]) -> dict[str, Contrast]:
            return {name: _with_sign_0(contrast) for name, contrast in contrasts.items()}

        return replace(
            self,
            effects=undecided(self.effects),
            changes=undecided(self.changes),
            turns=dict.fromkeys(self.turns, "none"),
            unsettled=(),
            repairs={},
        )


def family_of(
    question: Question,
    facts: ComparisonFacts,
    conditions: Sequence[Condition],
    trials: Trials,
    untested: Sequence[str],
) -> tuple[PairedTrials, TestedContrasts]:
    """Return the trials of an audit that are compared, and what is decided of them.

    `UserError` when no pair is left, and where newly trained models are asked for and too few
    trainings gave different outcomes.
    """
    names = [condition.name for condition in conditions]
    comparison = compared(question.repair, question.baseline, names, trials)
    if question.generalise == "models":
        columns = np.concatenate([part for pair in comparison.success.values() for part in pair])
        ran = np.all([~np.isnan(a - b).all(axis=0) for a, b in comparison.success.values()], axis=0)
        trainings = len({column.tobytes() for column in columns.T[ran]})
        if trainings < FEWEST_TRAININGS:
            raise UserError(
                f"only {trainings} of the {len(facts.seeds)} trainings ran under each condition "
                f"and gave different outcomes, and what holds for newly trained models needs "
                f"{FEWEST_TRAININGS}: leave --generalise models out."
            )
    family = decide_conditions(
        comparison.success,
        primary=facts.primary,
        models=question.generalise == "models",
        untested=untested,
        shares=alpha_shares(names, facts.primary) if facts.order is not None else None,
    )
    return comparison, family


def decide_conditions(
    success: Mapping[str, Outcomes],
    *,
    primary: str = "",
    models: bool = False,
    untested: Collection[str] = (),
    alpha: float = ALPHA,
    shares: Mapping[str, float] | None = None,
) -> TestedContrasts:
    """Return what is decided of all conditions, from successes `[scenes, seeds]` alone, not a
    number where a trial has no outcome.

    This is the rule of `faultpath audit`, without words and without secondary outcomes, and what
    simulations of its error rates call. The family holds the effect under every condition and every
    change from an isolated condition to `SHARED`, each over the scenes that have its trials; Holm's
    procedure runs over all of them at `alpha`, by a `rule` that is weighted with the parts of
    `alpha_shares` for the `primary` condition. Conditions in `untested` (the fault never acted
    there) take no part. `models` speaks of newly trained models as well. `shares` of `alpha`, by
    the names of `alpha_shares`, say that the audit was sequential: what is decided then holds at
    whatever scene it stopped, each contrast at its own share. Where trials are missing, what is
    decided has to be so too with all of them against it.
    """
    success = {
        condition: (np.asarray(one, np.float64), np.asarray(two, np.float64))
        for condition, (one, two) in success.items()
    }
    measure = Measure(models, shares is not None)
    tested = [condition for condition in success if condition not in untested]
    family = measure.tested(measure.contrasts(success, success, tested))
    parts = alpha_shares(tested, default_primary(primary, success))
    weights = {name: parts[name] for name in family}
    decide: Decide = partial(decide_family, alpha=alpha, shares=shares, weights=weights)
    decided = decide(family)
    fills, unsettled = dict[str, tuple[Contrast, Contrast]](), list[str]()
    if any_missing(success):
        low, high = (
            {condition: filled(pair, favour) for condition, pair in success.items()}
            for favour in (False, True)
        )
        fills = {
            condition: (measure.effect(*low[condition]), measure.effect(*high[condition]))
            for condition in low
        }
        least = decide(nearest_to_nothing(measure, low, high, tested, decided))
        unsettled = [name for name, c in decided.items() if c.sign not in (0, least[name].sign)]
    repairs = {
        condition: repairs_needed(
            decided, effect_name(condition), success[condition], measure, decide
        )
        for condition in tested
        if effect_name(condition) in unsettled
    }
    decided |= {name: _with_sign_0(decided[name]) for name in unsettled}
    effects = {
        condition: decided.get(effect_name(condition)) or with_test(measure.effect(*pair))
        for condition, pair in success.items()
    }
    changes = {
        condition: decided[change_name(condition)]
        for condition in isolated(tested)
        if change_name(condition) in decided
    }
    lopsided = [condition for condition, pair in success.items() if uneven(pair)]
    needed = fewest_scenes(alpha * max(weights.values()) / ordered_sum(weights.values()))
    if shares is not None:
        needed = betting.fewest_scenes(alpha * max(shares.values()))
    return TestedContrasts(
        effects=effects,
        changes=changes,
        turns={
            condition: _turn(condition, effects, moved, lopsided)
            for condition, moved in changes.items()
        },
        hypotheses=len(family if shares is None else shares),
        scenes_needed=needed,
        measure=measure,
        fills=fills,
        uneven=lopsided,
        unsettled=unsettled,
        repairs=repairs,
    )


def _turn(
    condition: str, effects: Mapping[str, Contrast], moved: Contrast, uneven: Collection[str]
) -> Turn:
    """Return what sharing does to the effect under an isolated condition; no reversal rests on a
    condition where the trials of one version failed more often."""
    if condition in uneven or SHARED in uneven:
        return "interaction" if moved.sign else "none"
    return turn(effects[condition], effects[SHARED], moved)


def _with_sign_0(contrast: Contrast) -> Contrast:
    return replace(contrast, test=contrast.test and contrast.test._replace(sign=0))
