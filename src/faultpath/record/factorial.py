"""The full factorial of a fault over the modules that read its source: main effects, interactions.

Every subset of the modules is struck. Each factor is a module, at two levels: it gets the fault, or
its reading. The effect of a set of factors is the difference between the mean over the subsets that
hold an even number fewer of them and the mean over all others, so that a main effect is the mean
with the module struck minus the mean without, and an interaction of two is half of what striking
one changes the other's effect by (Box, Hunter and Hunter, "Statistics for Experimenters", ch. 5).
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import combinations

from faultpath.errors import UserError
from faultpath.record import words
from faultpath.record.compared import compared
from faultpath.record.factors import OUTCOMES, Factorial, FactorialEffect, FactorialOf
from faultpath.record.family import ALPHA, CORRECT, SHARED, Arms
from faultpath.record.question import Question
from faultpath.statistics import (
    Contrast,
    Resamples,
    decide_family,
    fewest_scenes,
    success_effect,
    weighted_sum,
    with_test,
)
from faultpath.trials.table import OutcomeTable

JOINED = "+"
"""Between modules in the name of a path; no module's name holds it."""
_MOST = 6
"""Modules of a factorial: 64 arms of each variant."""


def subsets(modules: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Yield every subset, the empty one first."""
    for size in range(len(modules) + 1):
        yield from combinations(modules, size)


def path_of(struck: Sequence[str], modules: Sequence[str]) -> str:
    """Return the path on which these of the modules are struck, and no others."""
    if len(struck) == len(modules) > 1:
        return SHARED
    return JOINED.join(struck) or CORRECT


def check_factors(modules: Sequence[str]) -> None:
    """Raise `UserError` unless there are at least two, and few enough to strike every subset."""
    if not 2 <= len(modules) <= _MOST:
        raise UserError(
            f"the fault reaches {len(modules)} of the modules ({', '.join(modules)}): a factorial "
            f"takes 2 to {_MOST}."
        )


def factorial(
    asked: Question, factors: tuple[str, ...], table: OutcomeTable, resamples_seed: int = 0
) -> Factorial:
    """Return all effects, decided together: Holm's procedure over every one of them.

    Success of the baseline, of the repair, and their difference are told. They are compared on the
    scenes that every arm has; without one there are no effects, and a sentence says so. Raises as
    `compared`.
    """
    paths = {path_of(struck, factors): struck for struck in subsets(factors)}
    found = compared(asked.repair, asked.baseline, paths, table)
    if found.void:
        said = f"No pair is left where {' and '.join(found.void)} is struck: no factorial effects."
        return Factorial(factors=factors, paths=tuple(paths), words=(said,))
    arms = {path: each.arms for path, each in found.trials.items()}
    resamples = Resamples.draw(asked.library_hash, found.scenes, seed=resamples_seed)
    family: dict[tuple[FactorialOf, tuple[str, ...]], Contrast] = {
        (of, each): with_test(weighted_sum(_weights(each, paths.values()), contrasts), asked.rule)
        for of, contrasts in _contrasts(arms, resamples, asked).items()
        for each in subsets(factors)
        if each
    }
    decided = decide_family({_name(*key): contrast for key, contrast in family.items()})
    effects = tuple(_effect(asked, *key, decided[_name(*key)]) for key in family)
    return Factorial(
        factors=factors,
        paths=tuple(paths),
        scenes=found.scenes,
        hypotheses=len(family),
        effects=effects,
        words=tuple(_sentences(asked, effects, found.scenes)),
    )


def _weights(effect: tuple[str, ...], all_struck: Collection[tuple[str, ...]]) -> list[float]:
    """Return what each arm counts for: the product of +1 for a struck factor and -1 for another,
    over half the number of arms."""
    return [
        (-1.0) ** len(set(effect) - set(struck)) * 2.0 / len(all_struck) for struck in all_struck
    ]


def _contrasts(
    arms: Mapping[str, Arms], resamples: Resamples, asked: Question
) -> dict[FactorialOf, list[Contrast]]:
    """Return for each outcome its contrasts, arm by arm.

    A variant's success counts from that under correct inputs: weights add up to 0, so what is
    taken off everywhere takes nothing from an effect.
    """
    repair, baseline = arms[CORRECT]

    def against(of: FactorialOf, path: str) -> Contrast:
        first, second = arms[path]
        pair = {"baseline": (second, baseline), "repair": (first, repair)}.get(of, (first, second))
        models = asked.generalise == "models"
        return success_effect(*pair, resamples, models=models, rule=asked.rule)

    return {of: [against(of, path) for path in arms] for of in OUTCOMES}


def _name(of: FactorialOf, effect: tuple[str, ...]) -> str:
    return f"{of}/{JOINED.join(effect)}"


def _effect(
    asked: Question, of: FactorialOf, factors: tuple[str, ...], found: Contrast
) -> FactorialEffect:
    assert found.test is not None
    assert found.decision is not None
    estimate = found.estimate().model_copy(update={"estimand": words.estimand(asked)})
    return FactorialEffect(
        of=of,
        factors=factors,
        effect=estimate,
        sign=found.sign,
        test=found.test.name,
        p_value=found.test.p_value,
        adjusted_p_value=found.decision.adjusted_p,
    )


def _sentences(asked: Question, effects: Sequence[FactorialEffect], scenes: int) -> Iterator[str]:
    """Say what was decided, what an effect is, and what it was corrected for."""
    needed = fewest_scenes(ALPHA / len(effects))
    about = {"difference": f"{asked.repair} minus {asked.baseline}", "baseline": asked.baseline}
    for each in effects:
        if each.sign:
            named, of = " × ".join(each.factors), about.get(each.of, asked.repair)
            what = "interaction" if len(each.factors) > 1 else "main effect"
            yield f"The {what} of {named} on {of} is detected ({each.effect.value:+.1f} pp)."
    if scenes < needed:
        yield f"With {scenes} scenes no factorial effect can be detected: that takes {needed}."
    elif not any(each.sign for each in effects):
        yield "No factorial effect is detected."
    yield (
        "A main effect is success with the module struck minus without, over all combinations of "
        "the others; an interaction is half of what striking one changes the other's effect by."
    )
    yield (
        f"Holm's correction is for these {len(effects)} effects, apart from those of the paths "
        "above."
    )
