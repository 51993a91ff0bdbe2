"""A statement of a claim: what is looked at, and the rule that answers."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

from faultpath.record import Answer, ClaimVerdict, Part
from faultpath.statistics import Contrast
from faultpath.studies.claims.rules import Judged, Rule
from faultpath.studies.claims.sizes import NO_EFFECT, size
from faultpath.studies.published import Printed, PublishedClaim
from faultpath.studies.results import NotRun, Quantity, Results, Undecidable


class Stated(Protocol):
    """One part of a claim."""

    @property
    def words(self) -> str:
        """The statement."""
        ...

    @property
    def paper(self) -> Printed | None:
        """The paper's figure for it."""
        ...

    def part(self, results: Results) -> Part:
        """Answer it from a run; raises `NotRun` or `Undecidable`."""
        ...


Statements: TypeAlias = tuple[Stated, ...]


@dataclass(frozen=True)
class Statement:
    """A part of a claim that a rule decides from one quantity."""

    subject: str
    """What is looked at, as the beginning of a sentence; differences are first minus second."""
    quantity: Quantity
    rule: Rule
    paper: Printed | None = None
    """The paper's figure for the quantity, in its unit; `None` where it prints none."""

    @property
    def words(self) -> str:
        """The statement."""
        return self.rule.words.format(self.subject)

    def part(self, results: Results) -> Part:
        """Answer it from a run."""
        found = self.quantity(results)
        no_effect = NO_EFFECT.get(found.unit) if self.rule.sided else None
        return shown(self.words, self.rule.judge(found), found, self.paper, no_effect)


def shown(
    words: str,
    judged: Judged,
    found: Contrast,
    paper: Printed | None,
    no_effect: float | None,
    counts: str = "",
) -> Part:
    """Return an answer with the numbers that it rests on, and its size beside the paper's figure.

    `no_effect` as in `size`; `counts` where the quantity has none of its own.
    """
    return Part(
        words=words,
        answer=judged.answer,
        estimate=found.value,
        interval=found.interval,
        unit=found.unit,
        p_value=None if found.test is None else found.test.p_value,
        test="" if found.test is None else found.test.name,
        mde=found.least,
        counts=str(found.counts or counts),
        reason=judged.reason,
        size=size(found.value, found.interval, found.n_scenes, paper, no_effect),
        **beside(paper),
    )


def beside(paper: Printed | None) -> dict[str, Any]:
    """Return the fields of a part that hold the paper's figure."""
    return {} if paper is None else {"paper": paper.value, "paper_interval": paper.interval}


def verdict(claim: PublishedClaim, statements: Statements, results: Results) -> ClaimVerdict:
    """Answer a claim: confirmed when every part is, refuted when any is.

    Its numbers are those of the first part that has the answer of the whole.
    """
    parts = tuple(answered(statement, results) for statement in statements)
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


def answered(statement: Stated, results: Results) -> Part:
    """Answer a statement from a run; what was not run, or does not decide, leaves it undecided."""

    def left_open(reason: str, **why: Any) -> Part:
        why |= beside(statement.paper)
        return Part(words=statement.words, answer="undecided", reason=reason, **why)

    try:
        return statement.part(results)
    except NotRun as missing:
        return left_open(f"not run: {missing}", not_run=True)
    except Undecidable as why:
        return left_open(str(why))


def _together(answers: Sequence[Answer]) -> Answer:
    if "refuted" in answers:
        return "refuted"
    return "undecided" if "undecided" in answers else "confirmed"
