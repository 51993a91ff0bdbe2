"""Contrasts, conditions and shares in words, from their results and nothing else."""

from collections.abc import Iterator, Sequence

from faultpath.analyses.effects import Change, Effect
from faultpath.analyses.facts import ComparisonFacts, Facts, Question
from faultpath.analyses.model import (
    CORRECT,
    SHARED,
    AuditResult,
    ConditionBreakEven,
    Invalid,
    where,
)
from faultpath.core.text import capital, counted, series
from faultpath.report.sentences.wording import interval, p_equals, p_value, signed, with_interval
from faultpath.stats.distributions import sign_p_value

NO_RESULT: dict[Invalid, str] = {
    "unrepeatable": "No result: trials do not repeat.",
    "unpaired": "No result: the two versions did not meet the same conditions.",
}
"""Headlines of results in which nothing can be significant."""


def scenes_like_these(facts: Facts) -> str:
    """Return what a result of given models holds for."""
    return "new scenes like these" + (", for these trained models" if facts.trained else "")


def estimand(question: Question, facts: ComparisonFacts) -> str:
    """Return what intervals and tests speak of."""
    if question.generalise == "models":
        return "new scenes like these and models newly trained with other seeds"
    if facts.unit == "task":
        return "new tasks like these"
    return scenes_like_these(facts)


_TESTS = {
    "E+M (Lloyd)": "if both versions were equally good, the largest chance of a split as uneven as "
    "this one of the scenes that one version alone wins, however many these are",
    "E+M and score of scenes": "the larger p-value of two, of a score test on the mean over scenes "
    "and of E+M (Lloyd) with as many scenes as tell as much",
    "exact McNemar": "if both versions were equally good, the chance of a split as uneven as this "
    "one of the scenes that one version alone wins",
    "sign test": "whether each version is ahead in as many scenes as the other",
    "t test of seeds": "the largest p-value of three, of a t test of a mean effect of trainings of "
    "0, if they spread as a Gaussian does, and of both tests of scenes",
    "t test": "whether the mean effect of trainings is 0, if they spread as a Gaussian does",
    "bets on the mean": "bets against a mean of 0, which hold at whatever scene one stops",
}
"""Meaning of a p-value, by the beginning of its test's name."""


def tests(result: AuditResult) -> str:
    """Return which tests gave which p-values, with a sentence on each; empty where none did."""
    by_name: dict[str, list[str]] = {}
    for effect in result.effects:
        title = result.titles[effect.condition]
        by_name.setdefault(effect.test, []).append(f"{title} {p_value(effect.p_value)}")
    sentences: list[str] = []
    for name, values in by_name.items():
        means = next((words for test, words in _TESTS.items() if name.startswith(test)), "")
        what = f"{capital(name)}: {means}. " if means else f"{capital(name)}. "
        sentences.append(f"{what}p, before correction: {', '.join(values)}.")
    return " ".join(sentences)


def margin(result: AuditResult) -> str:
    """Return the margin below which a sequential audit counts a difference as small."""
    return f"{result.question.margin_pp or 0.0:g} pp"


def adjusted(result: AuditResult, difference: Effect | Change) -> str:
    """Return `p = 0.250 after Holm`; nothing where nothing was tested."""
    if difference.corrected_p is None:
        return ""
    family = "after Holm" if result.facts.order is None else "within the family"
    return f"{p_equals(difference.corrected_p)} {family}"


def only_alone(difference: Effect | Change) -> bool:
    """Return whether the interval excludes 0 and yet the difference is not significant."""
    low, high = difference.interval or (0.0, 0.0)
    tested = difference.corrected_p is not None and not (difference.sign or difference.unsettled)
    return tested and (low > 0 or high < 0)


def failed_more(result: AuditResult, effect: Effect) -> str:
    """Say which version's trials failed more often than chance explains."""
    missing, question = effect.missing, result.question
    more = missing is not None and missing.repair > missing.baseline
    return f"trials of {question.repair if more else question.baseline} failed more often"


def places(effects: Sequence[Effect]) -> str:
    """Return where effects are, the first one's kind first, modules faulted alone together."""
    alone = [effect.condition for effect in effects if effect.condition not in (CORRECT, SHARED)]
    joined = where(" or the ".join(alone))
    named = (joined if effect.condition in alone else where(effect.condition) for effect in effects)
    return series(list(dict.fromkeys(named)))


def in_short(result: AuditResult, effect: Effect | None) -> str:
    """Say in a few words what an audit found under one condition."""
    if effect is None:
        return "no pair of trials to compare"
    if not effect.acted:
        return "the fault never acted: not tested"
    if result.invalid:
        return NO_RESULT[result.invalid].rstrip(".").lower()
    if effect.sign:
        at = f", but at the {effect.extreme}" if effect.extreme else ""
        at = at or (", but trials failed unevenly" if effect.uneven else "")
        return f"{result.winner(effect.sign)} succeeds more often{at}"
    if effect.unsettled:
        return "not significant: failed or missing trials could undo the difference"
    if result.few:
        return "too few scenes"
    p = f" ({adjusted(result, effect)})" if only_alone(effect) else ""
    if result.is_small(effect):
        return f"the two differ by less than {margin(result)}{p}"
    return f"no significant difference{p}"


def change(result: AuditResult, change: Change) -> str:
    """Say whether sharing the fault reverses the ranking, changes the difference, or neither."""
    effects = {effect.condition: effect for effect in result.effects}
    if result.invalid:
        return (
            f"Nothing follows of the change from the effect {where(change.isolated)} to that "
            f"{where(SHARED)}."
        )
    ends = effects[change.isolated], effects[SHARED]
    values = " to ".join(f"{signed(end.value)} pp" for end in ends)
    numbers = f"{values}; change {signed(change.value)} pp {interval(change)}".rstrip()
    numbers += f", {adjusted(result, change)}"
    numbers += ": not significant, although the interval excludes 0" if only_alone(change) else ""
    alone, shared = where(change.isolated), where(SHARED)
    if change.turn == "reversal":
        one, other = (result.winner(end.sign) for end in ends)
        aside = " An effect at the floor or ceiling carries no headline."
        return (
            f"Sharing the fault reverses the ranking: {alone}, {one} succeeds more often; "
            f"{shared}, {other} does ({numbers})."
            f"{aside if any(end.extreme for end in ends) else ''}"
        )
    if change.turn == "interaction":
        return (
            f"Significant interaction: the difference is not the same {alone} as {shared} "
            f"({numbers}); a reversal is not shown."
        )
    between = f"between the effect {alone} and that {shared} ({numbers})"
    if change.unsettled:
        return (
            f"No change is significant {between}: failed or missing trials could undo the one seen."
        )
    return f"No change is significant {between}."


def no_pair(condition: str) -> str:
    """Say that a condition has no pair of trials to compare."""
    return f"{capital(where(condition))}, no pair of trials is left to compare"


def not_standing(result: AuditResult) -> Iterator[str]:
    """Say of each interval that excludes 0 without a significant difference why it is not one."""
    contrasts = counted(result.testing.hypotheses, "contrast")
    for effect in () if result.invalid else filter(only_alone, result.effects):
        yield (
            f"{capital(where(effect.condition))}, the interval excludes 0, but "
            f"{adjusted(result, effect)} ({contrasts}): the difference is not significant."
        )


def earlier_analyses(result: AuditResult) -> str:
    """Say what was concluded before, and what that does to what is significant now."""
    earlier = result.earlier
    counts = sorted({analysis.scenes for analysis in earlier if analysis.scenes is not None})
    with_scenes = f" with {series([str(n) for n in counts])} scenes" if counts else ""
    primaries = series(list(dict.fromkeys(f"'{analysis.primary}'" for analysis in earlier)))
    instead = (
        "" if result.facts.order else ", or with --stop-when, which allows for several analyses"
    )
    return (
        f"This audit was concluded before{with_scenes}, led by {primaries}: after an earlier "
        "analysis, more than 5 % of audits would report a difference between equally good "
        f"versions. Run it in scenes that no audit has used{instead}."
    )


def for_trainings(result: AuditResult) -> Iterator[str]:
    """Say on what a result for newly trained models rests, and in how many trainings which version
    is ahead, by a sign test: that holds whatever the distribution of trainings."""
    if result.question.generalise != "models" or result.invalid:
        return
    run = min((len(effect.per_seed) for effect in result.effects), default=0)
    yield (
        f"{run} trainings stand for new ones as far as trainings spread evenly around their "
        "mean, as a Gaussian does: a rare collapse that none of them had is not seen."
    )
    for effect in result.effects:
        if not effect.acted:
            continue
        values = effect.per_seed
        repair, baseline = sum(value > 0 for value in values), sum(value < 0 for value in values)
        even = len(values) - repair - baseline
        ahead = f"{result.winner(repair - baseline)} is ahead in {max(repair, baseline)}"
        if repair == baseline:
            ahead = (
                f"each version is ahead in {repair}"
                if repair
                else "neither version is ahead in any"
            )
        yield (
            f"{capital(where(effect.condition))}, {ahead} of {len(values)} trainings"
            f"{f', neither in {even}' if even and even < len(values) else ''}, "
            f"{p_equals(sign_p_value(repair, baseline))} (sign test, whatever their distribution)."
        )


def in_trials_that_ran(result: AuditResult) -> Iterator[str]:
    """Say what the trials that ran show where only those that failed stand in the way."""
    question = result.question
    for effect in result.effects:
        if not effect.unsettled or effect.missing is None:
            continue
        text = (
            f"{capital(where(effect.condition))}, the trials that ran favour "
            f"{result.winner(1 if effect.value > 0 else -1)} ({with_interval(effect)} pp, "
            f"{adjusted(result, effect)}), which holds if failing has nothing to do with how a "
            "trial would have ended"
        )
        if effect.missing.reruns is not None:
            counts = zip(effect.missing.reruns, (question.repair, question.baseline), strict=True)
            needed = series([f"{count} of {name}" for count, name in counts if count])
            how = "the same command tries them again"
            if result.facts.judged:
                how = "add their outcomes to the results"
            text += (
                f"; otherwise failed trials have to run and come out as the others did, at least "
                f"{needed} ({how})"
            )
        yield f"{text}."


def scenes_run(result: AuditResult) -> str:
    """Return `100 scenes`, and of how many where an audit could have taken more."""
    most = counted(result.facts.n_scenes, result.facts.unit)
    if result.stopped is None or result.stopped.scenes == result.facts.n_scenes:
        return most
    return f"{result.stopped.scenes} of at most {most}"


def stopping(result: AuditResult) -> str:
    """Return how a sequential audit was to stop; empty for one that is not."""
    order, margin_pp = result.facts.order, result.question.margin_pp
    if order is None:
        return ""
    every = result.question.stop_when == "all-decided"
    what = "every effect" if every else "the primary contrast"
    small = f" or shown to be smaller than {margin_pp:g} pp" if margin_pp else ""
    return (
        f"the audit was to stop once {what} is significant{small}, analysed after every "
        f"{'scene' if order.per_analysis == 1 else f'{order.per_analysis} scenes'}, or after "
        f"{result.facts.n_scenes}; the order of its scenes was drawn beforehand from the hash "
        f"of the library and the seed {order.seed}"
    )


FREQUENCY = {
    "everywhere": "at every frequency",
    "many": "where the fault is frequent; how rare it may be is open",
    "few": "where the fault is rare; how frequent it may be is open",
}
BETA = {
    "everywhere": "at every beta",
    "many": "where most of its faults are common cause; how few may be is open",
    "few": "where few of its faults are common cause; how many may be is open",
}


def ahead(question: Question, share: ConditionBreakEven, beta: bool = False) -> str:
    """Return who is ahead at which frequencies of the fault, or at which beta; empty for nobody."""
    clauses: list[str] = []
    for part in share.ahead:
        version = question.repair if part.sign > 0 else question.baseline
        where = (BETA if beta else FREQUENCY).get(part.where, f"{part.where} {part.percent} %")
        clauses.append(f"{version} is ahead {where}{' on' if part.where == 'from' else ''}")
    return ", ".join(clauses)
