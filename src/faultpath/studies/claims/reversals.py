"""Whether an effect is above 0 in one condition and below 0 in another."""

from collections.abc import Callable
from dataclasses import dataclass

from faultpath.statistics import change, decide_family, turn, with_test
from faultpath.studies.claims.rules import CONFIRMED, FEW_SCENES, REFUTED, Judged
from faultpath.studies.quantities.differences import Pair, together
from faultpath.studies.quantities.found import Found, Quantity, Undecidable, of_effect
from faultpath.studies.results import Results

ALL_SEEDS = 3
"""Trainings that the paper speaks of."""


@dataclass(frozen=True, kw_only=True)
class Turn(Found):
    """The change of an effect, second condition minus first, with the effect in both."""

    before: int
    """Side of 0 on which the effect is detected in the first condition."""
    after: int
    turned: bool
    """Whether the effect is detected above 0 before and below 0 after, the change among the family
    that is decided together."""


@dataclass(frozen=True)
class TurnsDown:
    """The effect is detected above 0 before and below 0 after."""

    def words(self, subject: str) -> str:
        """Return the statement."""
        return f"{subject} turns from above 0 to below 0"

    def judge(self, found: Turn) -> Judged:
        """Refute when the change, or either effect, is detected on the other side."""
        if found.interval is None:
            return FEW_SCENES
        if found.detected > 0 or found.before < 0 or found.after > 0:
            return REFUTED
        if found.turned:
            return CONFIRMED
        why = "the change is detected, but not both effects" if found.detected else ""
        return Judged("undecided", why)


def turned(before: Pair, after: Pair) -> Callable[[Results], Turn]:
    """Return the change of a difference in success from one pair of cells to another."""

    def found(results: Results) -> Turn:
        one, two = (contrast.draws for contrast in together(results, before, after))
        difference = change(one, two)
        shown = of_effect(difference)
        family = {"before": one, "after": two, "change": with_test(difference)}
        decided = decide_family(family)
        return Turn(
            value=shown.value,
            interval=shown.interval,
            unit=shown.unit,
            n_scenes=shown.n_scenes,
            mde=shown.mde,
            counts=f"{one.counts}, then {two.counts}",
            before=one.detected,
            after=two.detected,
            turned=turn(*decided.values()) == "reversal" and decided["before"].sign > 0,
        )

    return found


def seeds_that_turn(before: Pair, after: Pair) -> Quantity:
    """Return in how many seeds the difference is above 0 before and below 0 after."""

    def found(results: Results) -> Found:
        one, two = (contrast.draws for contrast in together(results, before, after))
        if one.n_seeds < ALL_SEEDS:
            raise Undecidable(f"run with {one.n_seeds} of {ALL_SEEDS} seeds")
        turning = sum(b > 0 > a for b, a in zip(one.per_seed, two.per_seed, strict=True))
        return Found(float(turning), None, "seeds", one.n_scenes)

    return found
