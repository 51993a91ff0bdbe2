"""The contrasts of an audit, tested together."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from faultpath.analyses.compared import Outcomes, PairedTrials, compared
from faultpath.analyses.contrasts import (
    Design,
    alpha_shares,
    change_name,
    default_primary,
    effect_name,
    isolated,
)
from faultpath.analyses.facts import ComparisonFacts, Question
from faultpath.analyses.missing import (
    Correct,
    MissingOutcomes,
    failed_unevenly,
    missing_outcomes,
)
from faultpath.analyses.model import SHARED, Condition
from faultpath.core.errors import UserError
from faultpath.run.question import FEWEST_TRAININGS
from faultpath.run.trials import Trials
from faultpath.stats import betting
from faultpath.stats.contrast import Contrast, ordered_sum
from faultpath.stats.decisions import Turn, decide_family, turn
from faultpath.stats.estimate import ALPHA
from faultpath.stats.power import fewest_scenes


@dataclass(frozen=True)
class TestedContrasts:
    """Every contrast of an audit, tested and corrected for their number."""

    effects: Mapping[str, Contrast]
    """By condition; one that is not corrected where the fault never acted."""
    changes: Mapping[str, Contrast]
    """Shared minus isolated, by the isolated condition."""
    turns: Mapping[str, Turn]
    """What sharing does to the effect, by the isolated condition."""
    hypotheses: int
    scenes_needed: int
    design: Design
    missing: MissingOutcomes
    uneven: Collection[str]
    """Conditions on which one version failed more often than chance explains."""

    def without_claims(self) -> "TestedContrasts":
        """Return the contrasts of trials that support no result: none is significant."""

        def not_significant(contrasts: Mapping[str, Contrast]) -> dict[str, Contrast]:
            return {name: _not_significant(contrast) for name, contrast in contrasts.items()}

        return replace(
            self,
            effects=not_significant(self.effects),
            changes=not_significant(self.changes),
            turns=dict.fromkeys(self.turns, "none"),
            missing=replace(self.missing, unsettled=(), reruns={}),
        )


def family_of(
    question: Question,
    facts: ComparisonFacts,
    conditions: Sequence[Condition],
    trials: Trials,
    untested: Sequence[str],
) -> tuple[PairedTrials, TestedContrasts]:
    """Return the paired trials of an audit, and their contrasts.

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
    """Return every contrast of an audit with its corrected test, from successes `[scenes, seeds]`
    by condition, not a number where a trial has no outcome.

    This is the rule of `faultpath audit`, without words and without secondary outcomes, and what
    simulations of its error rates call. The family holds the effect under every condition and every
    change from an isolated condition to `SHARED`, each over the scenes that have its trials. Holm's
    procedure, weighted with `alpha_shares` for the `primary` condition, runs over all of them at
    `alpha`. Conditions in `untested` (the fault never acted there) take no part. `models` speaks of
    newly trained models as well. `shares` of `alpha`, by the names of `alpha_shares`, say that the
    audit was sequential: what is significant then is so at whatever scene it stopped, each contrast
    at its own share. Where trials are missing, what is significant has to be so too with all of
    them against it.
    """
    success = {
        condition: (np.asarray(one, np.float64), np.asarray(two, np.float64))
        for condition, (one, two) in success.items()
    }
    design = Design(models, sequential=shares is not None)
    tested = [condition for condition in success if condition not in untested]
    contrasts = design.contrasts(tested, success)

    parts = alpha_shares(tested, default_primary(primary, success))
    weights = {name: parts[name] for name in contrasts}
    correct: Correct = partial(decide_family, alpha=alpha, shares=shares, weights=weights)
    corrected = correct(contrasts)

    missing = missing_outcomes(design, tested, success, corrected, correct)
    corrected |= {name: _not_significant(corrected[name]) for name in missing.unsettled}

    effects = {
        condition: corrected.get(effect_name(condition)) or design.effect(*pair)
        for condition, pair in success.items()
    }
    changes = {
        condition: corrected[change_name(condition)]
        for condition in isolated(tested)
        if change_name(condition) in corrected
    }
    uneven = [condition for condition, pair in success.items() if failed_unevenly(pair)]
    if shares is None:
        scenes_needed = fewest_scenes(alpha * max(weights.values()) / ordered_sum(weights.values()))
    else:
        scenes_needed = betting.fewest_scenes(alpha * max(shares.values()))
    return TestedContrasts(
        effects=effects,
        changes=changes,
        turns={
            condition: _turn(condition, effects, moved, uneven)
            for condition, moved in changes.items()
        },
        hypotheses=len(contrasts if shares is None else shares),
        scenes_needed=scenes_needed,
        design=design,
        missing=missing,
        uneven=uneven,
    )


def _turn(
    condition: str, effects: Mapping[str, Contrast], moved: Contrast, uneven: Collection[str]
) -> Turn:
    """Return what sharing does to the effect under an isolated condition; no reversal rests on a
    condition where the trials of one version failed more often."""
    if condition in uneven or SHARED in uneven:
        return "interaction" if moved.sign else "none"
    return turn(effects[condition], effects[SHARED], moved)


def _not_significant(contrast: Contrast) -> Contrast:
    return replace(contrast, test=contrast.test and contrast.test._replace(sign=0))
