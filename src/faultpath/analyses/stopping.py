"""Where a sequential audit stops, and what several analyses of the same trials cost."""

from collections.abc import Iterable, Sequence

from faultpath.analyses.descriptive import counts_of, untested_conditions
from faultpath.analyses.facts import ComparisonFacts, EarlierAnalysis, Question
from faultpath.analyses.family import TestedContrasts, family_of
from faultpath.analyses.model import AuditResult, Condition, StoppedAudit
from faultpath.core.errors import UserError
from faultpath.run.trials import Trials


def stops(
    question: Question, facts: ComparisonFacts, conditions: Sequence[Condition], trials: Trials
) -> bool:
    """Return whether a sequential audit stops with these trials; their order does not matter."""
    untested = untested_conditions(conditions, counts_of(question, conditions, trials))
    try:
        _, tested = family_of(question, facts, conditions, trials, untested)
    except UserError:  # no pair is sound so far
        return False
    state = stopped(question, facts, tested, trials)
    return state is not None and state.reached


def stopped(
    question: Question,
    facts: ComparisonFacts,
    tested: TestedContrasts,
    trials: Trials,
    valid: bool = True,
) -> StoppedAudit | None:
    """Return how a sequential audit stands with these trials; `None` for one that is not
    sequential. No difference is shown to be small by trials that are not `valid`.

    Every claim on a contrast, of who is ahead or of how little, follows from its one interval, at
    the level of its share.
    """
    if facts.order is None:
        return None
    small: list[str] = []
    for condition, effect in tested.effects.items():
        critical = effect.test.critical_p if effect.test else None
        if critical is None or effect.n_scenes < tested.scenes_needed:
            continue
        level, margin = 1.0 - critical, question.margin_pp or 0.0
        # Whatever failed trials would have been.
        filled = (effect, *tested.missing.bounds.get(condition, ()))
        ends = [contrast.ends(level) or (-100.0, 100.0) for contrast in filled]
        if all(-margin < low and high < margin for low, high in ends):
            small.append(condition)
    significant_or_small = {
        condition
        for condition, effect in tested.effects.items()
        if effect.sign or condition in small
    }
    required = set(tested.effects) if question.stop_when == "all-decided" else {facts.primary}
    scenes = len(trials.scenes)
    return StoppedAudit(
        scenes=scenes, reached=required <= significant_or_small, small=tuple(small) if valid else ()
    )


def with_earlier_analyses(record: AuditResult, earlier: Iterable[AuditResult]) -> AuditResult:
    """Return a record that tells of other conclusions from its trials, and what they cost.

    `earlier` are records of the same variants by the same code, with those that they tell of. The
    same question once more counts as none, and so does one with too few scenes to announce
    anything. A sequential audit allows for all analyses with the same primary contrast.
    """

    def analysis(record: AuditResult) -> EarlierAnalysis:
        question, facts = record.question, record.facts
        return EarlierAnalysis(
            scenes=None if facts.order else facts.n_scenes,
            primary=facts.primary,
            generalise="scenes" if facts.order else question.generalise,
        )

    known: list[EarlierAnalysis] = []
    for other in earlier:
        known += other.earlier if other.few else (*other.earlier, analysis(other))
    others = tuple(one for one in dict.fromkeys(known) if one != analysis(record))
    return record.model_copy(update={"earlier": others})
