"""A statement of a claim: what is looked at, and the rule that answers."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeAlias, TypeVar

from faultpath.record import Answer, ClaimVerdict, Part
from faultpath.studies.claims.rules import Judged, Rule
from faultpath.studies.published import PublishedClaim
from faultpath.studies.quantities.found import Found, Undecidable
from faultpath.studies.results import NotRun, Results

F = TypeVar("F", bound=Found)


@dataclass(frozen=True)
class Statement(Generic[F]):
    """One part of a claim."""

    subject: str
    """What is looked at, as the beginning of a sentence; differences are first minus second."""
    quantity: Callable[[Results], F]
    rule: Rule[F]

    def part(self, results: Results) -> Part:
        """Answer it from a run."""
        try:
            found = self.quantity(results)
        except NotRun as missing:
            return self._open(f"not run: {missing}", not_run=True)
        except Undecidable as why:
            return self._open(str(why))
        return _part(self.rule.words(self.subject), self.rule.judge(found), found)

    def _open(self, reason: str, not_run: bool = False) -> Part:
        words = self.rule.words(self.subject)
        return Part(words=words, answer="undecided", reason=reason, not_run=not_run)


Statements: TypeAlias = tuple[Statement[Any], ...]


def verdict(claim: PublishedClaim, statements: Statements, results: Results) -> ClaimVerdict:
    """Answer a claim: confirmed when every part is, refuted when any is.

    Its numbers are those of the first part that has the answer of the whole.
    """
    parts = tuple(statement.part(results) for statement in statements)
    answer = _together([part.answer for part in parts])
    deciding = next(part for part in parts if part.answer == answer)
    return ClaimVerdict(
        id=claim.id,
        kind=claim.kind,
        verdict=answer,
        estimate=deciding.estimate,
        interval=deciding.interval,
        mde=deciding.mde,
        unit=deciding.unit,
        paper=claim.paper,
        claim=claim.claim,
        parts=parts,
    )


def _together(answers: Sequence[Answer]) -> Answer:
    if "refuted" in answers:
        return "refuted"
    return "undecided" if "undecided" in answers else "confirmed"


def _part(words: str, judged: Judged, found: Found) -> Part:
    return Part(
        words=words,
        answer=judged.answer,
        estimate=found.value,
        interval=found.interval,
        unit=found.unit,
        p_value=None if found.test is None else found.test.p_value,
        test="" if found.test is None else found.test.name,
        mde=found.mde,
        counts=found.counts,
        reason=judged.reason,
    )
