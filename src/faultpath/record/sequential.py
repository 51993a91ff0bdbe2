"""When a sequential audit stops, and what is said of that."""

from faultpath.record.family import Family
from faultpath.record.model import Stopped
from faultpath.record.question import Question
from faultpath.record.words import margin


def stopped(question: Question, family: Family, scenes: int) -> Stopped | None:
    """Return how a sequential audit stands after so many scenes; `None` of one that is not."""
    rule = question.stop
    if rule is None:
        return None
    margin = rule.margin_pp or 0.0
    small = tuple(path for path in family.effects if _within(family, path, margin))
    settled = {path for path, effect in family.effects.items() if effect.sign or path in small}
    wanted = set(family.effects) if rule.when == "all-decided" else {question.primary}
    return Stopped(scenes=scenes, reached=wanted <= settled, small=small)


def _within(family: Family, path: str, margin_pp: float) -> bool:
    """Return whether the effect is smaller than the margin, at the level of its share.

    Every claim on a contrast, of who is ahead or of how little, follows from this one interval.
    """
    effect = family.effects[path]
    if effect.decision is None or effect.n_scenes < family.scenes_needed:
        return False
    level = 1.0 - effect.decision.critical_p
    for each in (effect, *family.fills.get(path, ())):  # whatever failed trials would have been
        low, high = each.ends(level) or (-100.0, 100.0)
        if low <= -margin_pp or high >= margin_pp:
            return False
    return True


def sentences(question: Question, held: Stopped | None) -> tuple[str, ...]:
    """Say how many scenes a sequential audit took and why, and what its intervals are."""
    rule = question.stop
    if rule is None or held is None:
        return ()
    taken = _counted(held.scenes, "scene")
    trials, most = held.scenes * rule.trials, question.n_scenes * rule.trials
    ending = f"and {_reason(question, held)}" if held.reached else f"but {_reason(question, held)}"
    if held.scenes == question.n_scenes:
        text = f"it took all that it was allowed, {taken} ({_counted(trials, 'trial')}), {ending}"
    else:
        text = f"{taken} of at most {question.n_scenes} ({trials} of {most} trials)"
        if held.reached:
            text = f"it stopped after {text}, because {_reason(question, held)}"
        else:
            text = f"it took {text}, {ending}"
    said = [
        f"This audit was sequential: {text}.",
        "Its scenes came in a random order fixed beforehand. Intervals and p-values hold at "
        "whatever scene an audit stops, and are wider for that than with a number of scenes fixed "
        "beforehand.",
    ]
    if held.reached:
        said.append(
            "A difference with which an audit stops is on average further from 0 than the true one."
        )
    return tuple(said)


def _reason(question: Question, held: Stopped) -> str:
    assert question.stop is not None
    rule, small = question.stop, f"smaller than {margin(question.stop)}"
    if rule.when == "all-decided":
        also = f" or {small}" if rule.margin_pp else ""
        return (
            f"every effect was decided{also}"
            if held.reached
            else f"not every effect was decided{also}"
        )
    if question.primary in held.small:
        return f"the primary contrast was shown to be {small}"
    return f"the primary contrast was {'' if held.reached else 'not '}decided"


def more(question: Question, held: Stopped | None, undecided: bool) -> tuple[str, ...]:
    """Say how an audit that stopped could go on; `undecided` says that an effect still is."""
    if question.stop is None or held is None or not undecided:
        return ()
    if held.reached:
        return ("More scenes: --stop-when all-decided goes on until every effect is decided.",)
    return (
        "More scenes: a larger --scenes goes on with those of the same order, and what is said "
        "then holds as well.",
    )


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
