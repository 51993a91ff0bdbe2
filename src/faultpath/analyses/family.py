"""The contrasts of an audit, tested together; several sizes of a fault as one family."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from faultpath.analyses.contrasts import (
    Design,
    Outcomes,
    PairedTrials,
    alpha_shares,
    change_name,
    compared,
    default_primary,
    effect_name,
    isolated,
)
from faultpath.analyses.facts import ComparisonFacts, Question
from faultpath.analyses.missing import Correct, MissingOutcomes, failed_unevenly, missing_outcomes
from faultpath.analyses.model import SHARED, AuditResult, Condition
from faultpath.core.errors import UserError
from faultpath.run.question import FEWEST_TRAININGS
from faultpath.run.trials import Trials
from faultpath.stats import betting
from faultpath.stats.contrast import Contrast, ordered_sum
from faultpath.stats.decisions import Turn, decide_family, holm, turn, with_test
from faultpath.stats.estimate import ALPHA, Sign
from faultpath.stats.power import fewest_scenes


@dataclass(frozen=True)
class TestedContrasts:
    """Every contrast of an audit, tested and corrected for their number."""

    effects: Mapping[str, Contrast]
    """By condition; one that is not corrected where the fault never acted."""
    changes: Mapping[str, Contrast]
    """Shared minus isolated, by the isolated condition."""
    turns: Mapping[str, Turn]
    """Effect of sharing the fault, by the isolated condition."""
    hypotheses: int
    """Number of contrasts that share the error rate."""
    scenes_needed: int
    """With fewer, nothing can be significant."""
    design: Design
    missing: MissingOutcomes
    uneven: Collection[str]
    """Conditions on which one version failed more often than chance explains."""

    def without_claims(self) -> "TestedContrasts":
        """Return the contrasts of trials that support no result: none is significant."""
        return replace(
            self,
            effects={name: _not_significant(effect) for name, effect in self.effects.items()},
            changes={name: _not_significant(change) for name, change in self.changes.items()},
            turns=dict.fromkeys(self.turns, "none"),
            missing=replace(self.missing, inconclusive=(), reruns={}),
        )


def family_of(
    question: Question,
    facts: ComparisonFacts,
    conditions: Sequence[Condition],
    trials: Trials,
    untested: Sequence[str],
) -> tuple[PairedTrials, TestedContrasts]:
    """Return the paired trials of an audit, and their contrasts.

    `UserError` when no pair is left, and where the question is of newly trained models and too few
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

    This is the rule of `faultpath audit`, without words and secondary outcomes; simulations of its
    error rates call it. The family holds the effect under every condition and every change from an
    isolated condition to `SHARED`, each over the scenes that have its trials. Holm's procedure,
    weighted with `alpha_shares` for the `primary` condition, corrects all of them at `alpha`.
    Conditions in `untested` (the fault never acted there) take no part. With `models` contrasts
    hold for newly trained models as well. `shares` of `alpha`, by the names of `alpha_shares`, are
    those of a sequential audit: each contrast is tested at its own share, at whatever scene the
    audit stopped. Where trials are missing, a significant contrast has to be so with all of them
    against it too.
    """
    success = {
        condition: (np.asarray(one, np.float64), np.asarray(two, np.float64))
        for condition, (one, two) in success.items()
    }
    design = Design(models, sequential=shares is not None)
    tested = [condition for condition in success if condition not in untested]

    # Every effect and change with its test, then corrected together.
    contrasts = design.contrasts(tested, success)
    parts = alpha_shares(tested, default_primary(primary, success))
    weights = {name: parts[name] for name in contrasts}
    correct: Correct = partial(decide_family, alpha=alpha, shares=shares, weights=weights)
    corrected = correct(contrasts)

    # A contrast that missing trials could undo is not significant.
    missing = missing_outcomes(design, tested, success, corrected, correct)
    corrected |= {name: _not_significant(corrected[name]) for name in missing.inconclusive}

    # By condition again; without correction where the fault never acted.
    effects = {
        condition: corrected.get(effect_name(condition)) or with_test(design.effect(*pair))
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
    """Return the effect of sharing the fault, from an isolated condition; no reversal rests on a
    condition where the trials of one version failed more often."""
    if condition in uneven or SHARED in uneven:
        return "interaction" if moved.sign else "none"
    return turn(effects[condition], effects[SHARED], moved)


def _not_significant(contrast: Contrast) -> Contrast:
    return replace(contrast, test=contrast.test and contrast.test._replace(sign=0))


def contrasts_of(result: AuditResult) -> dict[str, tuple[float, float]]:
    """Return p and weight of every contrast that was tested, by its name."""
    tested = [effect for effect in result.effects if effect.corrected_p is not None]
    p_values = {effect_name(effect.condition): effect.p_value for effect in tested}
    p_values |= {change_name(change.isolated): change.p_value for change in result.changes}
    parts = alpha_shares([effect.condition for effect in tested], result.facts.primary)
    return {name: (p, parts[name]) for name, p in p_values.items()}


def decide_sizes(
    results: Sequence[AuditResult], once: Collection[str] = ()
) -> list[dict[str, tuple[Sign, float]]]:
    """Return for each size of a fault, by condition, the side that is significantly ahead over all
    sizes, and the adjusted p.

    Holm's procedure over every contrast of every size, weighted as each audit by itself: whatever
    is significant then holds with an error of at most 5 % for all sizes together, and is so in its
    own audit too. Contrasts named in `once` are the same trials at every size, and one.
    """

    def key(size: int, name: str) -> str:
        return name if name in once else f"{size}/{name}"

    tested = {
        key(size, name): contrast
        for size, result in enumerate(results)
        for name, contrast in contrasts_of(result).items()
    }
    adjusted = holm(
        {name: p for name, (p, _) in tested.items()},
        {name: weight for name, (_, weight) in tested.items()},
    )
    families: list[dict[str, tuple[Sign, float]]] = []
    for size, result in enumerate(results):
        family: dict[str, tuple[Sign, float]] = {}
        for effect in result.effects:
            if effect.corrected_p is not None:
                p = adjusted[key(size, effect_name(effect.condition))]
                family[effect.condition] = effect.sign if p <= ALPHA else 0, p
        families.append(family)
    return families
