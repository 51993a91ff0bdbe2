"""Sentences on a record, from what was decided and nothing else."""

from collections.abc import Iterator
from typing import NamedTuple

from faultpath.decisions.model import Change, DecisionRecord, Effect
from faultpath.decisions.question import Question
from faultpath.decisions.wording import (
    capital,
    counted,
    first,
    interval,
    last,
    p_value,
    series,
    signed,
    where,
)
from faultpath.statistics.estimate import Region

FEW_TRAININGS = 10
"""With fewer, an interval for newly trained models rests on how trainings are distributed."""


_PAIRED = {
    "keys": "Trials are paired by their keys alone: nothing shows that both arms began alike.",
    "hashes": "Pairs share their keys and a hash of what they began with; nothing shows that later "
    "noise was the same.",
}


def estimand(question: Question) -> str:
    """Return what intervals and tests speak of."""
    if question.generalise == "models":
        return "new scenes like these and models newly trained with other seeds"
    if question.judged and question.judged.unit == "task":
        return "new tasks like these"
    return "new scenes like these" + (", for these trained models" if question.trained else "")


def reach(record: DecisionRecord) -> Iterator[str]:
    """Say how far the numbers reach, which seeds repeat, and how a sequential audit stopped."""
    question = record.question
    holds = "The intervals hold" if record.few else "What is significant holds"
    conditional = question.trained and question.generalise == "scenes"
    anew = "; models trained anew may differ" if conditional else ""
    yield f"{holds} for {record.estimand}{anew}."
    if question.judged:
        yield _PAIRED[question.judged.pairing]
        yield (
            "Of two equal arms at most 5 % of such judgements would find a difference, if the "
            "number of scenes was fixed before anybody looked: other tools do not tell."
        )
    run = len(question.seeds)
    if question.generalise == "models" and run < FEW_TRAININGS:
        yield (
            f"Caution: {run} trainings say little about new ones. With fewer than "
            f"{FEW_TRAININGS}, intervals hold only as far as trainings spread evenly around their "
            "mean."
        )
    differ = len(record.effects[0].wins) if record.effects else run
    if differ < run:
        same = "All" if differ == 1 else "Some of the"
        once = "together they count as one" if differ == 1 else f"they count as {differ}"
        yield f"{same} {run} seeds gave the same outcome in every trial: {once}."
    stopped, rule, most = record.stopped, question.stop, question.n_scenes
    if stopped is None or rule is None:
        return
    whole = stopped.scenes == most
    because = "but" if not stopped.reached else "and" if whole else "because"
    why = f"the primary contrast was {'' if stopped.reached else 'not '}decided"
    if rule.when == "all-decided":
        also = f" or smaller than {margin(record)}" if rule.margin_pp else ""
        why = f"{'every' if stopped.reached else 'not every'} effect was decided{also}"
    elif question.primary in stopped.small:
        why = f"the primary contrast was shown to be smaller than {margin(record)}"
    took = f"it {'stopped after' if stopped.reached else 'took'} {counted(stopped.scenes, 'scene')}"
    took += f" of at most {most}"
    if whole:
        took = f"it took all that it was allowed, {counted(stopped.scenes, 'scene')}"
    trials = counted(stopped.scenes * rule.trials, "trial")
    yield f"This audit was sequential: {took} ({trials}), {because} {why}."
    yield (
        "Its scenes came in a random order fixed beforehand. Intervals and p-values hold wherever "
        "an audit stops, and are wider for that."
    )
    if stopped.reached:
        yield "A difference with which an audit stops is on average further from 0 than the truth."


def looks(record: DecisionRecord) -> str:
    """Say what was concluded before, and what that does to what is announced now."""
    counts = sorted({look.scenes for look in record.earlier if look.scenes is not None})
    with_scenes = f" with {series([str(n) for n in counts])} scenes" if counts else ""
    led = series([f"'{name}'" for name in dict.fromkeys(look.primary for look in record.earlier)])
    return (
        f"This audit was concluded before{with_scenes}, led by {led}: after such a look, what it "
        "announces now is wrong more often than in 5 % of audits. Ask again of scenes that no "
        "audit has looked at, or with --stop-when, which allows for looks."
    )


def margin(record: DecisionRecord) -> str:
    """Return the margin below which a sequential audit counts a difference as small."""
    return f"{(record.question.stop and record.question.stop.margin_pp) or 0.0:g} pp"


def adjusted(record: DecisionRecord, of: Effect | Change) -> str:
    """Return `p = 0.250 after Holm`; nothing where nothing was tested."""
    if of.adjusted_p_value is None:
        return ""
    p = p_value(of.adjusted_p_value)
    return f"p {p if p.startswith('<') else f'= {p}'} {record.question.family}"


def only_alone(of: Effect | Change) -> bool:
    """Return whether the interval by itself leaves out 0 and yet nothing is detected."""
    low, high = of.estimate.interval or (0.0, 0.0)
    tested = of.adjusted_p_value is not None and not (of.sign or of.unsettled)
    return tested and (low > 0 or high < 0)


def change(record: DecisionRecord, of: Change) -> str:
    """Say whether sharing the fault reverses the ranking, changes the difference, or neither."""
    effects = {effect.path: effect for effect in record.effects}
    ends = effects[of.isolated], effects[of.shared]
    values = " to ".join(f"{signed(end.success.value)} pp" for end in ends)
    shown = f"{values}; change {signed(of.estimate.value)} pp {interval(of.estimate)}".rstrip()
    shown += f", {adjusted(record, of)}"
    shown += ": the interval alone decides nothing" if only_alone(of) else ""
    alone, shared = where(of.isolated), where(of.shared)
    if of.turn == "reversal":
        one, other = (record.winner(end.sign) for end in ends)
        at_end = any(end.extreme for end in ends)
        aside = " One of the two lies at the floor or ceiling: this carries no headline."
        return (
            f"Sharing the fault reverses the ranking: {alone}, {one} succeeds more often; "
            f"{shared}, {other} does ({shown}).{aside if at_end else ''}"
        )
    if of.turn == "interaction":
        return (
            f"Interaction detected: the difference is not the same {alone} as {shared} ({shown}); "
            "a reversal is not shown."
        )
    between = f"between the effect {alone} and that {shared} ({shown})"
    if of.unsettled:
        return f"Nothing is decided {between}: trials that failed could undo it."
    return f"{'Nothing is decided' if record.few else 'No change is detected'} {between}."


class Shares(NamedTuple):
    """How a share between two effects is called."""

    every: str
    many: str
    """Where it is large, with what is not decided."""
    few: str


FREQUENCY = Shares(
    "at every frequency",
    "where the fault is frequent; how rare it may be is not decided",
    "where the fault is rare; how frequent it may be is not decided",
)
"""The share of episodes with the fault."""
BETA = Shares(
    "at every beta",
    "where most of its faults are common cause; how few may be is not decided",
    "where few of its faults are common cause; how many may be is not decided",
)
"""The beta factor: of the faults of a module, the share that strikes all modules at once."""


def shares(
    question: Question, regions: tuple[Region, ...], none: Effect, all_: Effect, words: Shares
) -> str:
    """Return who is decided to be ahead at which shares; empty for nobody anywhere.

    A region counts where it reaches an end (a share of none, or of all) at which the family
    detects an effect on the same side, away from floor and ceiling: so no sentence contradicts
    that on the path.
    """
    clauses: list[str] = []
    for region in regions:
        low = region.low <= 0.0 and none.leads and region.sign == none.sign
        high = region.high >= 1.0 and all_.leads and region.sign == all_.sign
        ahead = f"{question.repair if region.sign > 0 else question.baseline} is ahead"
        if low and high:
            return f"{ahead} {words.every}"
        if high and region.low <= 0.0:
            clauses.append(f"{ahead} {words.many}")
        elif low and region.high >= 1.0:
            clauses.append(f"{ahead} {words.few}")
        elif high and first(region.low) < 100:
            clauses.append(f"{ahead} from {first(region.low)} % on")
        elif low and last(region.high) > 0:
            clauses.append(f"{ahead} up to {last(region.high)} %")
    return ", ".join(clauses)


def hardly_acted(record: DecisionRecord) -> Iterator[str]:
    """Name the arms in which the fault changed nothing in most of the trials."""
    acted = {effect.path for effect in record.effects if effect.acted}
    faulted = {path.name: (path.baseline_consumers, path.consumers) for path in record.paths}
    for cell in record.cells:
        consumers = faulted[cell.path][cell.variant == record.question.repair]
        if cell.path in acted and consumers and 2 * cell.altered_trials < cell.trials:
            yield (
                f"{capital(where(cell.path))}, the fault changed something in only "
                f"{cell.altered_trials} of {cell.trials} trials of {cell.variant}."
            )


def would_change(record: DecisionRecord) -> Iterator[str]:
    """Say what would change the verdict."""
    stopped, tested = record.stopped, [effect for effect in record.effects if effect.acted]
    judged = record.question.judged is not None
    if stopped and not all(effect.sign for effect in record.effects):
        yield (
            "More scenes: --stop-when all-decided goes on until every effect is decided."
            if stopped.reached
            else "More scenes: a larger --scenes goes on with those of the same order, and what is "
            "said then holds as well."
        )
    if record.few:
        yield f"More scenes: {record.scenes_needed} at least, and more for all but a clear winner."
    if len(tested) < len(record.effects):
        yield "A fault that acts: an onset before the trial ends, a size that changes what is read."
    if any(effect.extreme == "floor" for effect in tested):
        yield "Easier scenes or a smaller fault: where both fail, a difference can hardly show."
    if any(effect.extreme == "ceiling" for effect in tested):
        yield "Harder scenes or a larger fault: where both succeed, a difference can hardly show."
    if not record.few and any(e.minimum_detectable_pp and not e.sign for e in tested):
        instead = "" if judged else ", or --stop-when, which allows for looks"
        yield (
            f"Fresh scenes, which no audit has looked at, and more of them{instead}: they find "
            "smaller differences. Adding scenes to this audit would break its 5 %."
        )
    if judged:
        yield "Other scenes, other conditions: none of these is among the results."
    else:
        yield "Another size or sign of the fault, another library or wiring: none of these was run."


def no_pair(path: str) -> str:
    """Say that a path has no pair of trials to compare."""
    return f"{capital(where(path))}, no pair of trials is left to compare and nothing is decided"


def partly_measured(record: DecisionRecord) -> Iterator[str]:
    """Say of which metrics not every trial has a value."""
    for effect in record.effects:
        for name in record.question.metrics:
            whole = effect.metrics[name].n_scenes if name in effect.metrics else 0
            if whole < effect.scenes and (whole or record.question.judged):
                scenes = f"{whole} of {counted(effect.scenes, 'scene')}"
                yield (
                    f"{capital(where(effect.path))}, {name} is compared in {scenes}: only there "
                    "does every trial have it."
                )


def failed_trials(record: DecisionRecord) -> Iterator[str]:
    """Say by arm and path how many trials failed, and what their outcomes could make of it."""
    question = record.question
    for effect in record.effects:
        failed = effect.failed
        if failed is None or not (failed.repair or failed.baseline or failed.unsettled):
            continue
        yield (
            f"{capital(where(effect.path))}, {failed.repair} trials of {question.repair} failed"
            f"{' or are missing' if question.judged else ''} and {failed.baseline} of "
            f"{question.baseline}: depending on how they would have ended, the "
            f"difference over all scenes lies anywhere from {signed(failed.against_pp)} to "
            f"{signed(failed.favour_pp)} pp."
        )
