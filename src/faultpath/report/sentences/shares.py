"""At which shares, of faulty episodes or of common causes, a version is ahead, in words."""

from faultpath.analyses.facts import Question
from faultpath.analyses.model import ConditionBreakEven

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
