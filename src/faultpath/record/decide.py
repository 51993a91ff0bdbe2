"""From the outcome table to the decision record."""

from collections.abc import Mapping, Sequence
from statistics import median

from faultpath.errors import UserError
from faultpath.record.model import (
    Cell,
    DecisionRecord,
    Effect,
    Path,
    PathBreakEven,
    Question,
    Reversal,
)
from faultpath.record.words import CORRECT, SHARED, effect_words, reversal_words, verdict
from faultpath.statistics import (
    Comparison,
    Decision,
    Estimate,
    Resamples,
    break_even,
    compare,
    decide_family,
    detectable,
    difference_of_effects,
    discordant_by_seed,
    mcnemar_mid_p,
    mean_effect,
    median_effect,
    mixture_curve,
    success_effect,
    turn,
)
from faultpath.statistics import Effect as Draws
from faultpath.trials.outcome import Status
from faultpath.trials.pairing import Bools, Floats, Pairs, Side, mismatch_words, pair
from faultpath.trials.table import OutcomeTable

MIN_JOINT_SCENES = 6
"""Fewer scenes than this cannot give a two-sided 95 % interval of a median: 2 / 2^5 > 0.05."""


def decide(
    question: Question,
    paths: Sequence[Path],
    table: OutcomeTable,
    resamples_seed: int = 0,
    findings: Sequence[str] = (),
) -> DecisionRecord:
    """Return the decision record of an audit.

    Scenes in which a pair is void on any path are left out of all of them, so that every effect
    speaks of the same scenes and shares one set of bootstrap resamples. The record carries
    `findings`, and what was found about its pairs. `UserError` when no scene is left.
    """
    pairs = _common({path.name: _pair(question, path.name, table) for path in paths})
    mismatches = [each for path in pairs.values() for each in path.mismatches]
    n_scenes = len(next(iter(pairs.values())).scenes)
    if n_scenes == 0:
        raise UserError(
            "no scene is left to compare, because in each of them a trial failed: mend what made "
            "it fail, or choose other scenes."
        )
    resamples = Resamples.draw(question.library_hash, n_scenes, seed=resamples_seed)
    draws = {
        name: success_effect(each.first.success, each.second.success, resamples)
        for name, each in pairs.items()
    }
    found = {f"effect/{name}": compare(effect) for name, effect in draws.items()} | {
        f"change/{name}": compare(difference_of_effects(draws[name], draws[SHARED]))
        for name in draws
        if name not in (CORRECT, SHARED) and SHARED in draws
    }
    decided = decide_family(found)
    effects = {
        name: _effect(
            question, name, each, found[f"effect/{name}"], decided[f"effect/{name}"], resamples
        )
        for name, each in pairs.items()
    }
    breaks = [_break_even(name, draws) for name in draws if name != CORRECT]
    turns = [
        _reversal(question, effects[name], effects[SHARED], found[f"change/{name}"], decided)
        for name in draws
        if f"change/{name}" in found
    ]
    ordered = tuple(effects.values())
    return DecisionRecord(
        question=question,
        paths=tuple(paths),
        cells=tuple(
            _cell(table, variant, path.name)
            for path in paths
            for variant in (question.baseline, question.repair)
        ),
        effects=ordered,
        break_even=tuple(breaks),
        reversals=tuple(turns),
        verdict=verdict(question, ordered, breaks, turns),
        findings=(*mismatch_words(mismatches), *findings),
    )


def _pair(question: Question, path: str, table: OutcomeTable) -> Pairs:
    return pair(table, Side(question.repair, path), Side(question.baseline, path))


def _common(pairs: dict[str, Pairs]) -> dict[str, Pairs]:
    every = [set(each.scenes) for each in pairs.values()]
    first = next(iter(pairs.values()))
    kept = tuple(scene for scene in first.scenes if all(scene in scenes for scenes in every))
    return {name: each.only(kept) for name, each in pairs.items()}


def _effect(
    question: Question,
    path: str,
    pairs: Pairs,
    found: Comparison,
    decision: Decision,
    resamples: Resamples,
) -> Effect:
    first, second = pairs.first, pairs.second
    counts = discordant_by_seed(first.success, second.success).per_seed
    joint = first.success & second.success
    effect = Effect(
        path=path,
        success=found.estimate,
        pairs=len(first.success),
        void_pairs=pairs.void,
        wins=tuple(count.first_only for count in counts),
        losses=tuple(count.second_only for count in counts),
        test=found.test.name,
        p_value=found.test.p_value,
        mid_p_value=mcnemar_mid_p(counts[0]).p_value if len(counts) == 1 else None,
        minimum_detectable_pp=detectable(
            first.success, second.success, alpha=decision.critical_p
        ).value,
        detected=decision.sign != 0,
        time_s=_time(pairs, joint, resamples),
        joint_successes=int(joint.sum()),
        terminal_distance_m=_mean(first.terminal_distance_m, second.terminal_distance_m, resamples),
        min_clearance_m=_mean(first.min_clearance_m, second.min_clearance_m, resamples),
        words="",
    )
    return effect.model_copy(update={"words": effect_words(question, effect)})


def _time(pairs: Pairs, joint: Bools, resamples: Resamples) -> Estimate | None:
    """Median within-scene difference over joint successes; too few of them have no interval."""
    if not joint.any():
        return None
    estimate = median_effect(pairs.first.time_s, pairs.second.time_s, joint, resamples).estimate()
    if estimate.n_scenes >= MIN_JOINT_SCENES:
        return estimate
    return estimate.model_copy(
        update={
            "low": None,
            "high": None,
            "method": f"median of {estimate.n_scenes} scenes, too few for an interval",
        }
    )


def _mean(first: Floats | None, second: Floats | None, resamples: Resamples) -> Estimate | None:
    if first is None or second is None:
        return None
    return mean_effect(first, second, resamples, "m").estimate()


def _break_even(path: str, draws: dict[str, Draws]) -> PathBreakEven:
    correct, faulty = draws[CORRECT], draws[path]
    return PathBreakEven(
        path=path, result=break_even(correct, faulty), curve=mixture_curve(correct, faulty)
    )


def _reversal(
    question: Question,
    isolated: Effect,
    shared: Effect,
    change: Comparison,
    decided: Mapping[str, Decision],
) -> Reversal:
    kind = turn(
        decided[f"effect/{isolated.path}"],
        decided[f"effect/{shared.path}"],
        decided[f"change/{isolated.path}"],
    )
    return Reversal(
        isolated=isolated.path,
        shared=shared.path,
        change=change.estimate,
        reversed=kind == "reversal",
        words=reversal_words(question, isolated, shared, kind == "reversal"),
    )


def _cell(table: OutcomeTable, variant: str, path: str) -> Cell:
    rows = [row for seed in table.seeds(variant, path) for row in table.arm(variant, path, seed)]
    outcomes = [row.outcome for row in rows]
    count = {status: sum(o.status is status for o in outcomes) for status in Status}
    ran = len(outcomes) - count[Status.FAILED]
    times = [o.time_s for o in outcomes if o.status is Status.SUCCESS]
    return Cell(
        variant=variant,
        path=path,
        trials=len(outcomes),
        success=count[Status.SUCCESS],
        crash=count[Status.CRASH],
        timeout=count[Status.TIMEOUT],
        failed=count[Status.FAILED],
        success_percent=100 * count[Status.SUCCESS] / ran if ran else 0.0,
        median_time_s=median(times) if times else None,
        struck_trials=sum(o.struck_steps > 0 for o in outcomes),
        altered_trials=sum(o.altered_steps > 0 for o in outcomes),
    )
