"""From the outcome table to the decision record."""

from collections.abc import Callable, Collection, Mapping, Sequence

from faultpath.errors import UserError
from faultpath.record import breakeven_words, sequential, void_words, words
from faultpath.record.cells import arms_shown, untested_paths
from faultpath.record.compared import Compared, PathTrials, compared
from faultpath.record.family import (
    CORRECT,
    SHARED,
    Family,
    alpha_shares,
    decide_paths,
    led,
    percent,
)
from faultpath.record.headline import headline
from faultpath.record.model import Change, DecisionRecord, Effect, Path, PathBreakEven, Verdict
from faultpath.record.question import Question
from faultpath.record.secondary import secondary
from faultpath.record.voids import Arms, Voids, filled
from faultpath.statistics import (
    Contrast,
    Estimate,
    Resamples,
    break_even,
    detectable,
    mixture_curve,
    only,
)
from faultpath.statistics.distributions import sign_mid_p_value, sign_p_value
from faultpath.statistics.estimate import Discordant
from faultpath.statistics.rules import EM
from faultpath.trials.pairing import mismatch_words
from faultpath.trials.table import OutcomeTable


def decide(
    question: Question,
    paths: Sequence[Path],
    table: OutcomeTable,
    resamples_seed: int = 0,
    findings: Sequence[str] = (),
) -> DecisionRecord:
    """Return the decision record of an audit.

    Scenes in which a pair is void on any path are left out of all of them, so that every effect
    speaks of the same scenes; a path that would leave no scene is left out itself, and named. Seeds
    that gave the same outcomes everywhere are counted once. The record carries `findings`, and what
    was found about its pairs. `UserError` when no scene is left under correct inputs, for a primary
    path that the audit does not have, and where newly trained models are asked for and all seeds
    gave the same.
    """
    asked = question.model_copy(update={"primary": primary_path(question.primary, paths)})
    found = _compared(asked, paths, table)
    trials = found.trials
    if question.generalise == "models" and found.seeds[1] < 2:
        raise UserError(
            "all seeds gave the same outcome in every trial, so they say nothing of newly trained "
            "models: leave --generalise models out."
        )
    n_scenes = found.scenes
    cells = arms_shown(asked, paths, table)
    untested = untested_paths(paths, cells)
    resamples = Resamples.draw(question.library_hash, n_scenes, seed=resamples_seed)
    family = _family(asked, paths, found, untested, resamples)
    stopped = sequential.stopped(asked, family, _scenes(table))
    estimand = words.estimand(asked)
    about = words.About(
        asked, n_scenes, family.scenes_needed, frozenset(stopped.small if stopped else ())
    )
    effects = tuple(
        _effect(about, name, each, family, resamples, untested, found.voids)
        for name, each in trials.items()
    )
    changes = tuple(_change(about, name, family, effects) for name in family.changes)
    breaks = tuple(
        _break_even(about, name, family, effects)
        for name in trials
        if name != CORRECT and name not in untested
    )
    return DecisionRecord(
        question=asked,
        paths=tuple(paths),
        cells=cells,
        effects=effects,
        changes=changes,
        break_even=breaks,
        scenes=n_scenes,
        scenes_needed=family.scenes_needed,
        hypotheses=family.hypotheses,
        estimand=estimand,
        verdict=Verdict(
            headline=headline(about, effects, changes),
            sentences=(
                *words.opening(about, found.seeds),
                *sequential.sentences(asked, stopped),
                *(effect.words for effect in effects),
                *(change.words for change in changes),
                *breakeven_words.sentences(breaks, effects),
                *words.barely_acted(asked, paths, cells),
                *words.saturated(asked, effects),
            ),
            would_change=(
                *sequential.more(asked, stopped, not all(effect.detected for effect in effects)),
                *words.would_change(about, effects),
            ),
        ),
        stopped=stopped,
        # Those of a record that is decided anew are given, and among them what is found again.
        findings=tuple(
            dict.fromkeys(
                (
                    *void_words.void_paths(found.void),
                    *void_words.failed_trials(about, effects),
                    *mismatch_words(found.mismatches),
                    *findings,
                )
            )
        ),
    )


def stops(question: Question, paths: Sequence[Path], table: OutcomeTable) -> bool:
    """Return whether a sequential audit stops with these trials; their order does not matter."""
    try:
        found = _compared(question, paths, table)
    except UserError:  # no pair is sound so far
        return False
    untested = untested_paths(paths, arms_shown(question, paths, table))
    family = _family(question, paths, found, untested, None)
    held = sequential.stopped(question, family, _scenes(table))
    return held is not None and held.reached


def _compared(question: Question, paths: Sequence[Path], table: OutcomeTable) -> Compared:
    names = [path.name for path in paths]
    arms = question.repair, question.baseline
    return compared(*arms, names, table, distinct=question.stop is None)


def _family(
    question: Question,
    paths: Sequence[Path],
    found: Compared,
    untested: Collection[str],
    resamples: Resamples | None,
) -> Family:
    shares = alpha_shares([path.name for path in paths], question.primary)
    return decide_paths(
        {name: each.arms for name, each in found.trials.items()},
        rule=question.rule,
        primary=question.primary,
        resamples=resamples,
        models=question.generalise == "models",
        untested=untested,
        shares=None if question.stop is None else shares,
        voids=found.voids,
    )


def _scenes(table: OutcomeTable) -> int:
    return len({row.outcome.scene for row in table.rows})


def primary_path(named: str, paths: Sequence[Path]) -> str:
    """Return the path of the primary contrast: as named, else the shared one, else the isolated.

    `UserError` for a name that the audit does not have.
    """
    names = [path.name for path in paths]
    if named and named not in names:
        raise UserError(
            f"the audit has no path '{named}' to be its primary contrast: it has "
            f"{', '.join(names)}."
        )
    return led(named, names)


def _effect(
    about: words.About,
    path: str,
    trials: PathTrials,
    family: Family,
    resamples: Resamples,
    untested: Collection[str],
    voids: Mapping[str, Voids],
) -> Effect:
    repair, baseline = trials.arms
    found = family.effects[path]
    assert found.counts is not None
    assert found.test is not None
    counts = found.counts.per_seed
    others = secondary(trials.pairs, resamples, about.question)
    effect = Effect(
        path=path,
        success=_scoped(about, found),
        sign=found.sign,
        test=found.test.name,
        p_value=found.test.p_value,
        adjusted_p_value=found.decision.adjusted_p if found.decision else None,
        mcnemar_p_value=_exact(sign_p_value, counts) if found.test.name == EM else None,
        mid_p_value=_exact(sign_mid_p_value, counts)
        if len(counts) == 1 and not about.sequential
        else None,
        scenes=len(trials.pairs.scenes),
        void_pairs=trials.pairs.void,
        failed=filled(voids, family.fills, path, f"effect/{path}" in family.unsettled),
        wins=tuple(count.first_only for count in counts),
        losses=tuple(count.second_only for count in counts),
        baseline_percent=percent(baseline),
        repair_percent=percent(repair),
        extreme=family.extremes[path],
        acted=path not in untested,
        minimum_detectable_pp=_detectable(about, found, trials.arms),
        planning_detectable_pp=_detectable(about, found, trials.arms, on_top=True),
        time_s=others.time_s,
        joint_successes=others.joint_successes,
        metrics=others.metrics,
        metric_means=others.metric_means,
        thresholds=others.thresholds,
        words="",
    )
    return effect.model_copy(update={"words": words.effect_words(about, effect)})


def _detectable(
    about: words.About, found: Contrast, arms: Arms, on_top: bool = False
) -> float | None:
    """Return the least difference that the rule finds at the level that Holm left this contrast.

    None is known for newly trained models, whose spread a few seeds do not give, and of an audit
    that stops where it has decided.
    """
    if found.decision is None or about.question.generalise == "models" or about.sequential:
        return None
    rule, alpha = about.question.rule, found.decision.critical_p
    return detectable(*arms, rule=rule, alpha=alpha, on_top=on_top)


def _exact(test: Callable[[int, int], float], counts: Sequence[Discordant]) -> float:
    return test(counts[0].first_only, counts[0].second_only)


def _scoped(about: words.About, contrast: Contrast) -> Estimate:
    estimand = words.estimand(about.question)
    return contrast.estimate().model_copy(update={"estimand": estimand})


def _change(about: words.About, path: str, family: Family, effects: Sequence[Effect]) -> Change:
    found, of = family.changes[path], {effect.path: effect for effect in effects}
    assert found.test is not None
    assert found.decision is not None
    change = Change(
        isolated=path,
        shared=SHARED,
        change=_scoped(about, found),
        sign=found.sign,
        test=found.test.name,
        p_value=found.test.p_value,
        adjusted_p_value=found.decision.adjusted_p,
        unsettled=f"change/{path}" in family.unsettled,
        turn=family.turns[path],
        words="",
    )
    said = words.change_words(about, of[path], of[SHARED], change)
    return change.model_copy(update={"words": said})


def _break_even(
    about: words.About, path: str, family: Family, effects: Sequence[Effect]
) -> PathBreakEven:
    ends = family.effects[CORRECT], family.effects[path]
    level = 1.0 - min(end.decision.critical_p for end in ends if end.decision)
    found = break_even(*ends, level=level)
    of = {effect.path: effect for effect in effects}
    said = breakeven_words.clause(about.question, found.regions, of[CORRECT], of[path])
    result = only(found, breakeven_words.borne_out(found.regions, of[CORRECT], of[path]))
    curve = mixture_curve(*ends, level=level)
    return PathBreakEven(path=path, result=result, curve=curve, words=said)
