"""The contrasts of an audit and their joint decision."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from faultpath.core.errors import UserError
from faultpath.decisions.compared import Arms, ComparedTrials, Voids, compared
from faultpath.decisions.model import CORRECT, SHARED, Path
from faultpath.decisions.question import Question
from faultpath.statistics import betting
from faultpath.statistics.contrast import Contrast, change
from faultpath.statistics.decisions import Turn, decide_family, turn, with_test
from faultpath.statistics.effects import success_effect
from faultpath.statistics.estimate import ALPHA, RULES, PairedTest, RuleName
from faultpath.statistics.power import fewest_scenes
from faultpath.statistics.resamples import Resamples
from faultpath.trials.table import OutcomeTable


@dataclass(frozen=True)
class Family:
    """Every contrast of an audit with its decision."""

    effects: Mapping[str, Contrast]
    """By path; without a decision where nothing was tested."""
    changes: Mapping[str, Contrast]
    """Shared minus isolated, by the isolated path."""
    turns: Mapping[str, Turn]
    hypotheses: int
    scenes_needed: int
    fills: Mapping[str, tuple[Contrast, Contrast]]
    """By path, where trials failed: the effect with what they leave open against the repair, and
    for it."""
    unsettled: Collection[str]
    """Isolated paths whose change, and paths whose effect, would be decided but for those trials;
    by the names of `alpha_shares`."""


def family_of(
    question: Question,
    paths: Sequence[Path],
    table: OutcomeTable,
    untested: Sequence[str],
    n_resamples: int = 10_000,
) -> tuple[ComparedTrials, Resamples, Family]:
    """Return the trials of an audit that are compared, their resamples, and what is decided.

    `UserError` when no scene is left, and where newly trained models are asked for and all seeds
    gave the same.
    """
    names = [path.name for path in paths]
    sequential = question.stop is not None
    # The trials of a task are no seeds: those that came out alike are no repetition.
    tasks = question.judged is not None and question.judged.unit == "task"
    trials = compared(
        question.repair,
        question.baseline,
        names,
        table,
        distinct=not (sequential or tasks),
        judged=question.judged is not None,
    )
    if question.generalise == "models" and next(iter(trials.arms.values()))[0].shape[1] < 2:
        raise UserError(
            "all seeds gave the same outcome in every trial, so they say nothing of newly trained "
            "models: leave --generalise models out."
        )
    resamples = Resamples.draw(question.library_hash, trials.n_scenes, n_resamples=n_resamples)
    family = decide_paths(
        trials.arms,
        rule=question.rule,
        primary=question.primary,
        resamples=resamples,
        models=question.generalise == "models",
        untested=untested,
        shares=alpha_shares(names, question.primary) if sequential else None,
        voids=trials.voids,
    )
    return trials, resamples, family


def decide_paths(
    success: Mapping[str, Arms],
    *,
    rule: RuleName,
    primary: str = "",
    resamples: Resamples | None = None,
    models: bool = False,
    untested: Collection[str] = (),
    alpha: float = ALPHA,
    shares: Mapping[str, float] | None = None,
    voids: Mapping[str, Voids] | None = None,
) -> Family:
    """Return what is decided of all paths, from paired successes `[scenes, seeds]` alone.

    This is the rule of `faultpath audit`, without words and without secondary outcomes, and what
    simulations of its error rates call. The family holds the effect on every path and every change
    from an isolated path to `SHARED`; Holm's procedure runs over all of them at `alpha`, by a
    `rule` that is weighted with the parts of `alpha_shares` for the `primary` path. Paths in
    `untested` (the fault never acted there) take no part. `models` speaks of newly trained models
    as well. `resamples` are drawn where they are not given. `shares` of `alpha`, by the names of
    `alpha_shares`, say that the audit was sequential: what is decided then holds at whatever scene
    it stopped, each contrast at its own share. Where `voids` say that a trial of one arm alone
    failed, what is decided has to be so too with all open outcomes against it.
    """

    def effects_of(arms: Mapping[str, Arms], drawn: Resamples | None = None) -> dict[str, Contrast]:
        sequential, scenes = shares is not None, len(next(iter(arms.values()))[0])
        drawn = drawn or Resamples.draw("family", scenes, n_resamples=1)  # nothing rests on them
        return {
            path: success_effect(*pair, drawn, models=models, sequential=sequential, rule=rule)
            for path, pair in arms.items()
        }

    effects, voids = effects_of(success, resamples), voids or {}
    tested = [path for path in success if path not in untested]
    family = {name: with_test(c, rule) for name, c in _named(effects, effects, tested).items()}
    parts = alpha_shares(tested, led(primary, success))
    weights = {name: parts[name] for name in family} if RULES[rule].weighted else None
    decide = partial(decide_family, alpha=alpha, shares=shares, weights=weights)
    decided = decide(family)
    fills, unsettled = dict[str, tuple[Contrast, Contrast]](), list[str]()
    if voids:
        low = effects_of({path: void.against for path, void in voids.items()})
        high = effects_of({path: void.favour for path, void in voids.items()})
        fills = {path: (low[path], high[path]) for path in voids}
        if any(void.open for void in voids.values()):
            least = decide(_nearest_to_nothing(low, high, tested, rule))
            unsettled = [name for name, c in decided.items() if c.sign not in (0, least[name].sign)]
    for name in unsettled:
        decision = decided[name].decision
        decided[name] = replace(decided[name], decision=decision and decision._replace(sign=0))
    effects = {
        path: decided.get(effect_name(path), with_test(e, rule)) for path, e in effects.items()
    }
    changes = {path: decided[change_name(path)] for path in _isolated(tested)}
    uneven = [path for path, void in voids.items() if void.uneven]
    largest = max(weights.values()) / sum(weights.values()) if weights else 1.0 / len(family)
    needed = fewest_scenes(alpha * largest)
    if shares is not None:
        needed = betting.fewest_scenes(alpha * max(shares.values()))
    return Family(
        effects=effects,
        changes=changes,
        turns={path: _turn(path, effects, moved, uneven) for path, moved in changes.items()},
        hypotheses=len(family if shares is None else shares),
        scenes_needed=needed,
        fills=fills,
        unsettled=tuple(unsettled),
    )


def _turn(
    path: str, effects: Mapping[str, Contrast], moved: Contrast, uneven: Collection[str]
) -> Turn:
    """Return what sharing does to the effect on an isolated path; no reversal rests on a path where
    the trials of one arm failed more often."""
    if path in uneven or SHARED in uneven:
        return "interaction" if moved.sign else "none"
    return turn(effects[path], effects[SHARED], moved)


def _named(
    effects: Mapping[str, Contrast], alone: Mapping[str, Contrast], tested: Collection[str]
) -> dict[str, Contrast]:
    """Return the effects, and their changes from those `alone` to the shared one, by name."""
    changes = {
        change_name(path): change(alone[path], effects[SHARED]) for path in _isolated(tested)
    }
    return {effect_name(path): effects[path] for path in tested} | changes


def _nearest_to_nothing(
    low: Mapping[str, Contrast],
    high: Mapping[str, Contrast],
    tested: Collection[str],
    rule: RuleName,
) -> dict[str, Contrast]:
    """Return the tested contrasts, each as near to no difference as open outcomes allow, from the
    effects with these against the repair and for it."""
    least: dict[str, Contrast] = {}
    lowest, highest = _named(low, high, tested), _named(high, low, tested)
    for name in lowest:
        one, two = with_test(lowest[name], rule), with_test(highest[name], rule)
        assert one.test is not None
        assert two.test is not None
        if one.test.leans <= 0:
            nothing = replace(one, test=PairedTest(one.test.name, 1.0, 0))
            one = two if two.test.leans < 0 else nothing
        least[name] = one
    return least


def led(primary: str, paths: Collection[str]) -> str:
    """Return the primary path: as named, else the shared one, else the isolated."""
    isolated = [name for name in paths if name not in (CORRECT, SHARED)]
    return primary or (SHARED if SHARED in paths else (isolated or list(paths))[0])


def alpha_shares(paths: Collection[str], primary: str) -> dict[str, float]:
    """Return each contrast's share of the error rate, by its name, where they are not equal.

    The effect on the primary path, for which sequential audits stop, has a half; all others share
    the rest. Where that path has none, the others' shares are equal.
    """
    named = [*map(effect_name, paths), *map(change_name, _isolated(paths))]
    others = [name for name in named if name != effect_name(primary)]
    shares = dict.fromkeys(others, 0.5 / max(1, len(others)))
    return {effect_name(primary): 0.5 if others else 1.0, **shares}


def effect_name(path: str) -> str:
    """Name the effect on a path among the contrasts of a family."""
    return f"effect/{path}"


def change_name(path: str) -> str:
    """Name the change from an isolated path to the shared one, likewise."""
    return f"change/{path}"


def _isolated(tested: Collection[str]) -> list[str]:
    return [path for path in tested if path not in (CORRECT, SHARED)] if SHARED in tested else []
