"""From the outcome table to the decision record."""

from collections.abc import Sequence

from faultpath.core.errors import UserError
from faultpath.decisions.compared import ComparedTrials
from faultpath.decisions.descriptive import cells_of, percent, secondary, untested_paths
from faultpath.decisions.family import Family, change_name, effect_name, family_of, led
from faultpath.decisions.model import (
    AS_RUN,
    CORRECT,
    SHARED,
    Change,
    DecisionRecord,
    Effect,
    Extreme,
    FailedTrials,
    Path,
    PathBreakEven,
)
from faultpath.decisions.question import Question
from faultpath.decisions.sentences import phrases, wording
from faultpath.decisions.sentences.answers import in_words
from faultpath.decisions.stopping import stopped
from faultpath.statistics.breakeven import break_even, mixture_curve, only
from faultpath.statistics.distributions import sign_p_value
from faultpath.statistics.estimate import EM, Region
from faultpath.statistics.power import detectable
from faultpath.statistics.resamples import Resamples
from faultpath.trials.pairing import mismatch_words
from faultpath.trials.table import OutcomeTable

FLOOR_PERCENT, CEILING_PERCENT = 10.0, 90.0


def decide(
    question: Question, paths: Sequence[Path], table: OutcomeTable, findings: Sequence[str] = ()
) -> DecisionRecord:
    """Return the decision record of an audit.

    Scenes in which a pair is void on any path are left out of all of them, so that every effect
    speaks of the same scenes; a path that would leave no scene is left out itself, and named. Seeds
    that gave the same outcomes everywhere are counted once. The record carries `findings`, and what
    was found about its pairs. `UserError` when no scene is left under correct inputs, for a primary
    path that the audit does not have, and where newly trained models are asked for and all seeds
    gave the same.
    """
    question = question.model_copy(update={"primary": primary_path(question.primary, paths)})
    cells = cells_of(question, paths, table)
    # Whether a fault acted is told by receipts, and other tools' results have none.
    untested = () if question.judged else untested_paths(paths, cells)
    # Only times and metrics rest on resamples, and of very many scenes these take gigabytes.
    timed = any(cell.median_time_s is not None for cell in cells)
    resampled = question.judged is None or timed or bool(question.metrics)
    n_resamples = 10_000 if resampled else 1
    trials, resamples, family = family_of(question, paths, table, untested, n_resamples)
    effects = {
        path: _effect(question, path, trials, family, resamples, path not in untested)
        for path in trials.arms
    }
    record = DecisionRecord(
        question=question,
        paths=tuple(paths),
        cells=cells,
        effects=tuple(effects.values()),
        changes=tuple(_change(question, path, family) for path in family.changes),
        break_even=tuple(
            _break_even(
                question, path, family, (effects[CORRECT], effects[path]), phrases.FREQUENCY
            )
            for path in effects
            if path not in (CORRECT, AS_RUN, *untested)
        ),
        break_even_beta=tuple(
            _break_even(question, path, family, (effects[path], effects[SHARED]), phrases.BETA)
            for path in family.changes
        ),
        scenes=trials.n_scenes,
        scenes_needed=family.scenes_needed,
        hypotheses=family.hypotheses,
        estimand=phrases.estimand(question),
        stopped=stopped(question, family, table),
    )
    noted = (
        *(f"{phrases.no_pair(path)}: the table shows what failed." for path in trials.void),
        *phrases.failed_trials(record),
        *phrases.partly_measured(record),
        *mismatch_words(trials.mismatches),
        *findings,  # a record that is decided anew has some of the above already
    )
    return record.model_copy(update={**in_words(record), "findings": tuple(dict.fromkeys(noted))})


def primary_path(named: str, paths: Sequence[Path]) -> str:
    """Return the path of the primary contrast: as named, else the shared one, else the isolated.

    `UserError` for a name that the audit does not have.
    """
    names = [path.name for path in paths]
    if named and named not in names:
        raise UserError(
            f"the audit has no condition '{named}' for its primary contrast: it has "
            f"{', '.join(names)}."
        )
    return led(named, names)


def _effect(
    question: Question,
    path: str,
    trials: ComparedTrials,
    family: Family,
    resamples: Resamples,
    acted: bool,
) -> Effect:
    repair, baseline = trials.arms[path]
    effect, pairs = family.effects[path], trials.pairs[path]
    assert effect.counts is not None
    assert effect.test is not None
    counts = effect.counts.per_seed
    wins, losses = (tuple(getattr(c, f) for c in counts) for f in ("first_only", "second_only"))
    rates = percent(baseline), percent(repair)
    extreme: Extreme | None = "floor" if max(rates) < FLOOR_PERCENT else None
    if min(rates) > CEILING_PERCENT:
        extreme = "ceiling"
    failed, least = None, None
    if path in family.fills:
        (against, favour), voids = family.fills[path], trials.voids[path]
        failed = FailedTrials(
            repair=voids.failed[0],
            baseline=voids.failed[1],
            against_pp=against.value,
            favour_pp=favour.value,
            uneven=voids.uneven,
            unsettled=effect_name(path) in family.unsettled,
        )
    # None is known for newly trained models, whose spread a few seeds do not give, and of an audit
    # that stops where it has decided.
    if effect.decision and question.generalise == "scenes" and question.stop is None:
        level = effect.decision.critical_p
        least = detectable(repair, baseline, rule=question.rule, alpha=level, on_top=True)
    return Effect(
        path=path,
        success=effect.estimate().model_copy(update={"estimand": phrases.estimand(question)}),
        sign=effect.sign,
        test=effect.test.name,
        p_value=effect.test.p_value,
        adjusted_p_value=effect.decision.adjusted_p if effect.decision else None,
        mcnemar_p_value=sign_p_value(wins[0], losses[0]) if effect.test.name == EM else None,
        scenes=len(pairs.scenes),
        void_pairs=pairs.void,
        failed=failed,
        wins=wins,
        losses=losses,
        baseline_percent=rates[0],
        repair_percent=rates[1],
        extreme=extreme,
        acted=acted,
        minimum_detectable_pp=least,
        **secondary(pairs, resamples, question),
    )


def _change(question: Question, path: str, family: Family) -> Change:
    contrast = family.changes[path]
    assert contrast.test is not None
    assert contrast.decision is not None
    return Change(
        isolated=path,
        shared=SHARED,
        change=contrast.estimate().model_copy(update={"estimand": phrases.estimand(question)}),
        sign=contrast.sign,
        test=contrast.test.name,
        p_value=contrast.test.p_value,
        adjusted_p_value=contrast.decision.adjusted_p,
        unsettled=change_name(path) in family.unsettled,
        turn=family.turns[path],
    )


def _break_even(
    question: Question,
    path: str,
    family: Family,
    ends: tuple[Effect, Effect],
    shares: phrases.Shares,
) -> PathBreakEven:
    """Return where baseline and repair are even between the effects at two ends of a share."""
    at_none, at_all = ends
    tested = family.effects[at_none.path], family.effects[at_all.path]
    level = 1.0 - min(end.decision.critical_p for end in tested if end.decision)
    filled = [family.fills[end.path] for end in ends if end.path in family.fills]
    # Both ends with what failed trials leave open against the repair, and for it.
    fills = tuple(zip(*filled, strict=True)) if any(a.value != b.value for a, b in filled) else ()
    result = break_even(*tested, level=level, fills=fills)
    # What a table and a picture show is borne out by the effect at an end, and reaches it.
    kept: list[Region] = []
    for region in result.regions:
        low = region.low > 0.0 or (at_none.leads and region.sign == at_none.sign)
        high = region.high < 1.0 or (at_all.leads and region.sign == at_all.sign)
        inner = region.low > 0.0 and region.high < 1.0
        shown = wording.last(region.high) > 0 and wording.first(region.low) < 100
        if low and high and shown and not inner:
            kept.append(region)
    return PathBreakEven(
        path=path,
        result=only(result, kept),
        curve=mixture_curve(*tested, level=level, fills=fills),
        words=phrases.shares(question, result.regions, at_none, at_all, shares),
    )
