"""Whether an effect is above 0 in one condition and below 0 in another."""

from dataclasses import dataclass
from typing import NamedTuple

from faultpath.statistics import Contrast, change, decide_family, turn, with_test
from faultpath_quadrotor.paper.answers import Part
from faultpath_quadrotor.paper.claims.rules import CONFIRMED, FEW_SCENES, REFUTED, Judged
from faultpath_quadrotor.paper.claims.statement import shown
from faultpath_quadrotor.paper.published import Printed
from faultpath_quadrotor.paper.quantities.differences import Pair, together
from faultpath_quadrotor.paper.results import Quantity, Results, Undecidable, decisive

ALL_SEEDS = 3
"""Trainings that the paper speaks of."""


class Turned(NamedTuple):
    """The change of an effect, second condition minus first, with the effect in both."""

    change: Contrast
    before: Contrast
    after: Contrast

    def judge(self) -> Judged:
        """Answer that the effect turns from above 0 to below 0.

        Refuted when the change, or either effect, is detected on the other side. The family that
        is decided together are both effects and their change.
        """
        moved, before, after = self
        if moved.interval is None:
            return FEW_SCENES
        if moved.detected > 0 or before.detected < 0 or after.detected > 0:
            return REFUTED
        one, two, both = decide_family(
            {"before": before, "after": after, "change": with_test(moved, "exact")}
        ).values()
        if turn(one, two, both) == "reversal":
            return CONFIRMED
        why = "the change is detected, but not both effects" if moved.detected else ""
        return Judged("undecided", why)


@dataclass(frozen=True)
class TurnsDown:
    """The effect is detected above 0 before and below 0 after."""

    subject: str
    before: Pair
    after: Pair
    paper: Printed | None = None
    """The change that the paper's figures give."""

    @property
    def words(self) -> str:
        """The statement."""
        return f"{self.subject} turns from above 0 to below 0"

    def part(self, results: Results) -> Part:
        """Answer it from a run."""
        one, two = together(results, self.before, self.after)
        turned = Turned(decisive(change(one, two)), one, two)
        counts = f"{one.counts}, then {two.counts}"
        return shown(self.words, turned.judge(), turned.change, self.paper, 0.0, counts)


def seeds_that_turn(before: Pair, after: Pair) -> Quantity:
    """Return in how many seeds the difference is above 0 before and below 0 after."""

    def found(results: Results) -> Contrast:
        one, two = together(results, before, after)
        if one.n_seeds < ALL_SEEDS:
            raise Undecidable(f"run with {one.n_seeds} of {ALL_SEEDS} seeds")
        turning = sum(b > 0 > a for b, a in zip(one.per_seed, two.per_seed, strict=True))
        return Contrast(float(turning), "seeds", one.n_scenes, against_zero=False)

    return found
