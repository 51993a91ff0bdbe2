"""Results of the statistics: estimates, tests and break-even frequencies as data.

Models are frozen and refuse unknown fields and NaN, so a number that does not exist is ``None``.
Differences are always *first minus second*.
"""

from typing import Literal, NamedTuple, Self, TypeAlias

from pydantic import Field, model_validator

from faultpath.core.results import Frozen

ALPHA = 0.05
Sign: TypeAlias = Literal[-1, 0, 1]
FixedSize: TypeAlias = Literal["unconditional", "conditional"]
TestKind: TypeAlias = FixedSize | Literal["sequential"]
"""How paired outcomes are tested; `FixedSize` where the number of scenes was fixed beforehand.

`unconditional`: Lloyd's E+M test, for several seeds with the score; audits use it. `conditional`:
exact McNemar or the sign test, which take the number of discordant scenes as fixed; the paper uses
them. `sequential`: bets, valid whenever the audit stops.
"""

SCENES = "new scenes like these, for these trained models and recorded executions"
SCENES_AND_SEEDS = "new scenes like these and models newly trained with other seeds"


def sign_of(value: float) -> Sign:
    """Return 1, -1 or 0."""
    return 1 if value > 0 else -1 if value < 0 else 0


class Estimate(Frozen, allow_inf_nan=False):
    """A value, its interval, and what that interval generalises to.

    ``low`` and ``high`` are both None where there is no interval. ``per_seed`` holds the same
    quantity computed from each seed alone, in seed order.
    """

    value: float
    low: float | None = None
    high: float | None = None
    level: float = Field(default=0.95, gt=0.0, lt=1.0)
    unit: str = ""
    method: str
    estimand: str
    n_scenes: int = Field(ge=1)
    n_seeds: int = Field(ge=1)
    per_seed: tuple[float, ...] | None = None
    won: tuple[tuple[int, int], ...] | None = None
    """Seed by seed: number of scenes in which only the first succeeded, or only the second."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if (self.low is None) != (self.high is None):
            raise ValueError("an interval needs both ends or neither")
        if self.low is not None and self.high is not None and self.low > self.high:
            raise ValueError(f"interval [{self.low}, {self.high}] is upside down")
        return self

    @property
    def interval(self) -> tuple[float, float] | None:
        """Return (low, high), or None without an interval."""
        return None if self.low is None or self.high is None else (self.low, self.high)


class PairedTest(NamedTuple):
    """A two-sided test of no difference, and its correction within a family of tests."""

    name: str
    p_value: float
    leans: Sign
    """Side of 0 on which the difference would be significant, if the test rejected."""
    sign: Sign = 0
    """Side of 0 on which the difference is significant within the family; 0 where it is not."""
    corrected_p: float | None = None
    """Holm's; like `critical_p`, `None` outside of a family."""
    critical_p: float | None = None
    """Largest p at which it would be significant, given the others' p-values."""

    def rejects(self, alpha: float = ALPHA) -> bool:
        """Return whether this test by itself rejects "no difference" at level ``alpha``."""
        return self.p_value <= alpha


class Region(Frozen, allow_inf_nan=False):
    """Fault frequencies at which one variant is significantly ahead; ``sign`` 1: the first."""

    low: float = Field(ge=0.0, le=1.0)
    high: float = Field(ge=0.0, le=1.0)
    sign: Literal[-1, 1]


class BreakEven(Frozen, allow_inf_nan=False):
    """Fault frequency at which a repair's gain under faults offsets its cost without (Table V).

    ``pieces`` are the frequencies at which the expected difference cannot be distinguished from 0,
    a confidence set for the break-even frequency: one interval, none, all or two pieces.
    ``regions`` are the rest of the range, where one variant is significantly ahead. ``p_star`` is
    where the point estimates cross, None where they do not; no statement rests on it.
    """

    p_star: float | None = Field(ge=0.0, le=1.0)
    pieces: tuple[tuple[float, float], ...] = Field(max_length=2)
    kind: Literal["interval", "empty", "whole", "two pieces"]
    regions: tuple[Region, ...]
    level: float = Field(default=0.95, gt=0.0, lt=1.0)
    method: str
    estimand: str


TESTS = "E+M test and weighted Holm"
"""Name of the test and correction of an audit's effects."""
EM = "E+M (Lloyd)"
"""Name of the test of one seed."""
DEGREES = "E+M and score of scenes"
"""Name of the test of several seeds, and of changes."""
TRAININGS = f"t test of seeds, {DEGREES}"
"""Name of the test of newly trained models."""
