"""A statement of a claim: what is looked at, and the rule that answers."""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot
from typing import Any, NamedTuple, TypeAlias

from faultpath.report.sentences import wording
from faultpath.stats.contrast import Contrast, change
from faultpath.stats.resamples import ROUNDING
from faultpath_paper.answers import ClaimVerdict, Size, StatementPart
from faultpath_paper.cells import Printed, PublishedClaim
from faultpath_paper.claims.rules import (
    CONFIRMED,
    FEW_SCENES,
    REFUTED,
    Ends,
    Judged,
    points_decide,
    rule_of,
)
from faultpath_paper.detection import detection, least_detectable, resampled
from faultpath_paper.quantities.differences import Pair, together
from faultpath_paper.results import NotRun, Quantity, Results, Undecidable, decisive, quantity

NO_EFFECT = {"pp": 0.0, "s": 0.0, "m": 0.0, "m/s^2": 0.0, "times": 1.0}
"""Value of no effect, by unit; in any other unit, as for a share of scenes, there is no sign."""


def size(
    value: float | None,
    interval: Ends | None,
    n_scenes: int,
    paper: Printed | None,
    no_effect: float | None,
) -> Size:
    """Compare an estimate with the paper's figure; `no_effect` is `None` where there is no sign.

    Compatible: the 95 % interval of ours minus the paper's holds 0. Else a sign counts where a
    whole interval shows it, ours and, where it prints one, the paper's.
    """
    if paper is None or value is None or interval is None or not points_decide(n_scenes):
        return "not comparable"
    theirs = paper.interval or (paper.value, paper.value)
    if _compatible(value, interval, paper.value, theirs):
        return "compatible"
    if no_effect is None:
        return "other size"
    own, printed = _side(interval, no_effect), _side(theirs, no_effect)
    if not (own and printed):
        return "other size"
    return "right sign, other size" if own == printed else "other sign"


def _compatible(ours: float, interval: Ends, paper: float, theirs: Ends) -> bool:
    """Return whether the interval of a difference of independent estimates holds 0.

    It is made from both intervals without taking them to be symmetric (MOVER: Zou and Donner,
    Statistics in Medicine 27, 2008).
    """
    difference = ours - paper
    low = difference - hypot(ours - interval[0], theirs[1] - paper)
    high = difference + hypot(interval[1] - ours, paper - theirs[0])
    return low <= ROUNDING and high >= -ROUNDING


def _side(interval: Ends, of: float) -> int:
    return int(interval[0] > of) - int(interval[1] < of)


@dataclass(frozen=True)
class Statement:
    """One part of a claim."""

    words: str
    paper: Printed | None
    """The paper's figure, in the unit of the estimate; `None` where it prints none."""
    part: Callable[[Results], StatementPart]
    """Answers the statement from a run; raises `NotRun` or `Undecidable`."""


Statements: TypeAlias = tuple[Statement, ...]


def stated(words: str, quantity: Quantity, paper: Printed | None = None) -> Statement:
    """Return the statement that the rule of its last words decides from one quantity."""
    rule = rule_of(words)

    def part(results: Results) -> StatementPart:
        contrast = quantity(results)
        no_effect = NO_EFFECT.get(contrast.unit) if rule.sided else None
        return shown(words, rule.judge(resampled(contrast)), contrast, paper, no_effect)

    return Statement(words, paper, part)


def shown(
    words: str,
    judged: Judged,
    contrast: Contrast,
    paper: Printed | None,
    no_effect: float | None,
    counts: str = "",
) -> StatementPart:
    """Return an answer with the numbers that it rests on, and its size beside the paper's figure.

    `no_effect` as in `size`; `counts` where the quantity has none of its own.
    """
    score = None if contrast.scenes is None else contrast.interval
    contrast = resampled(contrast)
    return StatementPart(
        words=words,
        answer=judged.answer,
        estimate=contrast.value,
        interval=contrast.interval,
        score=score,
        unit=contrast.unit,
        p_value=None if contrast.test is None else contrast.test.p_value,
        test="" if contrast.test is None else contrast.test.name,
        mde=least_detectable(contrast),
        counts=wording.won(contrast.won) if contrast.won else counts,
        reason=judged.reason,
        size=size(contrast.value, contrast.interval, contrast.n_scenes, paper, no_effect),
        **beside(paper),
    )


def beside(paper: Printed | None) -> dict[str, Any]:
    """Return the fields of a part that hold the paper's figure."""
    return {} if paper is None else {"paper": paper.value, "paper_interval": paper.interval}


_FIRST_WINS = ("refuted", "undecided", "confirmed")


def verdict(claim: PublishedClaim, statements: Statements, results: Results) -> ClaimVerdict:
    """Answer a claim: confirmed when every part is, refuted when any is.

    Its numbers are those of the first part that has the answer of the whole.
    """
    parts = tuple(answered(statement, results) for statement in statements)
    deciding = min(parts, key=lambda part: _FIRST_WINS.index(part.answer))
    return ClaimVerdict(
        id=claim.id,
        kind=claim.kind,
        verdict=deciding.answer,
        estimate=deciding.estimate,
        interval=deciding.interval,
        mde=deciding.mde,
        unit=deciding.unit,
        paper=claim.paper,
        claim=claim.claim,
        parts=parts,
    )


def answered(statement: Statement, results: Results) -> StatementPart:
    """Answer a statement from a run; what was not run, or does not decide, leaves it undecided."""

    def left_open(reason: str, **fields: Any) -> StatementPart:
        fields |= beside(statement.paper)
        return StatementPart(words=statement.words, answer="undecided", reason=reason, **fields)

    try:
        return statement.part(results)
    except NotRun as missing:
        return left_open(f"not run: {missing}", not_run=True)
    except Undecidable as why:
        return left_open(str(why))


ALL_SEEDS = 3
"""Number of trainings in the paper."""


class Turned(NamedTuple):
    """The change of an effect, second condition minus first, with the effect in both."""

    change: Contrast
    before: Contrast
    after: Contrast

    def judge(self) -> Judged:
        """Judge whether the effect turns from above to below 0: both are detected, each by itself.

        That is an intersection-union test, whose level is that of each effect's. Refuted when the
        change, or either effect, is detected on the other side.
        """
        moved, before, after = (detection(resampled(contrast)) for contrast in self)
        if self.change.interval is None:
            return FEW_SCENES
        if moved > 0 or before < 0 or after > 0:
            return REFUTED
        if before and after:
            return CONFIRMED
        why = "the change is significant, but not both effects" if moved else ""
        return Judged("undecided", why)


def turns_down(words: str, before: Pair, after: Pair, paper: Printed) -> Statement:
    """Return the statement that an effect is detected above 0 before and below 0 after.

    `paper` is the change that the paper's figures give.
    """

    def part(results: Results) -> StatementPart:
        one, two = together(results, before, after)
        turned = Turned(decisive(change(one, two)), one, two)
        counts = ", then ".join(wording.won(effect.won or ()) for effect in (one, two))
        return shown(words, turned.judge(), turned.change, paper, 0.0, counts)

    return Statement(words, paper, part)


@quantity
def seeds_that_turn(results: Results, before: Pair, after: Pair) -> Contrast:
    """Return in how many seeds the difference is above 0 before and below 0 after."""
    one, two = together(results, before, after)
    if one.n_seeds < ALL_SEEDS:
        raise Undecidable(f"run with {one.n_seeds} of {ALL_SEEDS} seeds")
    turning = sum(b > 0 > a for b, a in zip(one.per_seed, two.per_seed, strict=True))
    return Contrast(float(turning), "seeds", one.n_scenes, against_zero=False)
