"""Where a sequential audit stops, and what several looks at the same trials cost."""

from collections.abc import Iterable, Sequence

from faultpath.analyses.descriptive import cells_of, untested_conditions
from faultpath.analyses.family import Family, family_of
from faultpath.analyses.model import Condition, StoppedAudit
from faultpath.analyses.question import EarlierLook, Question
from faultpath.analyses.record import DecisionRecord
from faultpath.analyses.sentences import phrases
from faultpath.core.errors import UserError
from faultpath.run.trials import Trials


def stops(question: Question, conditions: Sequence[Condition], trials: Trials) -> bool:
    """Return whether a sequential audit stops with these trials; their order does not matter."""
    untested = untested_conditions(conditions, cells_of(question, conditions, trials))
    try:
        _, family = family_of(question, conditions, trials, untested)
    except UserError:  # no pair is sound so far
        return False
    state = stopped(question, family, trials)
    return state is not None and state.reached


def stopped(question: Question, family: Family, trials: Trials) -> StoppedAudit | None:
    """Return how a sequential audit stands with these trials; `None` of one that is not.

    Every claim on a contrast, of who is ahead or of how little, follows from its one interval, at
    the level of its share.
    """
    rule = question.stop
    if rule is None:
        return None
    small: list[str] = []
    for condition, effect in family.effects.items():
        critical = effect.test.critical_p if effect.test else None
        if critical is None or effect.n_scenes < family.scenes_needed:
            continue
        level, margin = 1.0 - critical, rule.margin_pp or 0.0
        # Whatever failed trials would have been.
        filled = (effect, *family.fills.get(condition, ()))
        ends = [contrast.ends(level) or (-100.0, 100.0) for contrast in filled]
        if all(-margin < low and high < margin for low, high in ends):
            small.append(condition)
    settled = {
        condition
        for condition, effect in family.effects.items()
        if effect.sign or condition in small
    }
    required = set(family.effects) if rule.when == "all-decided" else {question.primary}
    scenes = len(trials.scenes)
    return StoppedAudit(scenes=scenes, reached=required <= settled, small=tuple(small))


def with_earlier_analyses(
    record: DecisionRecord, earlier: Iterable[DecisionRecord]
) -> DecisionRecord:
    """Return a record that tells of other conclusions from its trials, and what they cost.

    `earlier` are records of the same variants by the same code, with the looks that they tell of.
    The same question asked again is no look, and one with too few scenes to announce anything is
    none. A sequential audit allows for all looks with the same primary contrast.
    """

    def look(question: Question) -> EarlierLook:
        return EarlierLook(
            scenes=None if question.stop else question.n_scenes,
            primary=question.primary,
            generalise="scenes" if question.stop else question.generalise,
        )

    known: list[EarlierLook] = []
    for other in earlier:
        known += other.earlier if other.few else (*other.earlier, look(other.question))
    looks = tuple(one for one in dict.fromkeys(known) if one != look(record.question))
    if not looks:
        return record
    record = record.model_copy(update={"earlier": looks})
    return record.model_copy(update={"findings": (*record.findings, phrases.looks(record))})
