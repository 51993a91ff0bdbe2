"""What the statistics layer hands out: estimates, tests and break-even frequencies as data.

Every model is frozen, refuses unknown fields and refuses NaN, so a number that does not exist has
to be said with ``None`` and a reason. Differences are always *first minus second*.
"""

from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

SCENES = "new scenes like these, for these trained models and recorded executions"
SCENES_AND_SEEDS = "new scenes like these and models newly trained with other seeds"


class FrozenResult(BaseModel):
    """Base of all results: frozen, no unknown fields, no NaN and no infinity."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Discordant(FrozenResult):
    """Pairs in which exactly one arm succeeded; printed as the paper prints them, ``2:15``."""

    first_only: int = Field(ge=0)
    second_only: int = Field(ge=0)
    n_pairs: int | None = Field(default=None, ge=0, description="all pairs, concordant included")

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.n_pairs is not None and self.n_pairs < self.total:
            raise ValueError(f"{self.total} discordant pairs cannot come from {self.n_pairs} pairs")
        return self

    @property
    def total(self) -> int:
        """Return the number of discordant pairs."""
        return self.first_only + self.second_only

    def swapped(self) -> Self:
        """Return the counts with the arms exchanged."""
        return self.model_copy(
            update={"first_only": self.second_only, "second_only": self.first_only}
        )

    def __str__(self) -> str:
        return f"{self.first_only}:{self.second_only}"


class SeedCounts(FrozenResult):
    """Discordant counts of each seed, in seed order; printed ``2:15/2:11/2:9``."""

    per_seed: tuple[Discordant, ...] = Field(min_length=1)

    def swapped(self) -> Self:
        """Return the counts with the arms exchanged."""
        return self.model_copy(update={"per_seed": tuple(c.swapped() for c in self.per_seed)})

    def __str__(self) -> str:
        return "/".join(str(c) for c in self.per_seed)


class Estimate(FrozenResult):
    """A value, its interval, and what that interval generalises to.

    ``low`` and ``high`` are both None when no interval was asked for or none exists. ``per_seed``
    holds the same quantity computed from each seed alone, in seed order.
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
    counts: SeedCounts | None = None
    per_seed: tuple[float, ...] | None = None

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

    @property
    def detected_sign(self) -> Literal[-1, 0, 1]:
        """Return the side of 0 on which the whole interval lies; 0 when it touches 0 or is absent.

        Not detected is not equivalence: report the minimum detectable effect beside it.
        """
        if self.low is not None and self.low > 0:
            return 1
        return -1 if self.high is not None and self.high < 0 else 0

    def swapped(self) -> Self:
        """Return the same estimate with the arms exchanged: sign flipped, interval mirrored."""
        return self.model_copy(
            update={
                "value": _negated(self.value),
                "low": None if self.high is None else _negated(self.high),
                "high": None if self.low is None else _negated(self.low),
                "counts": None if self.counts is None else self.counts.swapped(),
                "per_seed": None
                if self.per_seed is None
                else tuple(_negated(v) for v in self.per_seed),
            }
        )

    def text(self, digits: int = 1) -> str:
        """Return ``-9.7 pp [-16.0, -4.0]``; without an interval only the value and unit."""
        head = f"{_shown(self.value, digits)} {self.unit}".rstrip()
        if self.low is None or self.high is None:
            return head
        return f"{head} [{_shown(self.low, digits)}, {_shown(self.high, digits)}]"


class TestResult(FrozenResult):
    """A two-sided test of no difference, with the counts that decide it."""

    __test__ = False  # pytest would otherwise try to collect the class

    name: str
    p_value: float = Field(ge=0.0, le=1.0)
    counts: Discordant
    alternative: Literal["two-sided"] = "two-sided"
    n_scenes: int | None = None
    n_seeds: int = 1

    def rejects(self, alpha: float = 0.05) -> bool:
        """Return whether the test rejects no difference at level ``alpha``."""
        return self.p_value <= alpha


class Region(FrozenResult):
    """Fault frequencies at which it is decided who is ahead; ``sign`` 1: the first arm."""

    low: float = Field(ge=0.0, le=1.0)
    high: float = Field(ge=0.0, le=1.0)
    sign: Literal[-1, 1]


class BreakEven(FrozenResult):
    """Fault frequency at which a repair's gain under faults offsets its cost without (Table V).

    ``pieces`` are the frequencies at which the expected difference is not told from 0, a confidence
    set for the break-even frequency: one interval, none at all, the whole range or two pieces.
    ``regions`` are what is left of the range, where it is decided who is ahead. ``p_star`` is where
    the point estimates cross, None where they do not; it decides nothing.
    """

    p_star: float | None = Field(ge=0.0, le=1.0)
    pieces: tuple[tuple[float, float], ...] = Field(max_length=2)
    kind: Literal["interval", "empty", "whole", "two pieces"]
    regions: tuple[Region, ...]
    level: float = Field(default=0.95, gt=0.0, lt=1.0)
    words: str
    """What is decided, from the regions alone; it goes on after the name of the first arm."""
    method: str
    estimand: str


class Detectable(FrozenResult):
    """The smallest absolute difference that a paired comparison would detect with a stated power.

    ``value`` is None exactly when ``reason`` says why there is none. ``discordant_rate`` is the
    share of scenes that was taken to differ; ``note`` states what had to be assumed for it.
    """

    value: float | None = Field(default=None, ge=0.0)
    reason: str | None = None
    unit: str = "pp"
    alpha: float = Field(gt=0.0, lt=1.0)
    power: float = Field(gt=0.0, lt=1.0)
    method: str
    n_scenes: int = Field(ge=1)
    n_seeds: int = Field(default=1, ge=1)
    discordant_rate: float | None = Field(default=None, ge=0.0, le=1.0)
    note: str | None = None

    @model_validator(mode="after")
    def _says_why(self) -> Self:
        if (self.value is None) == (self.reason is None):
            raise ValueError("a detectable difference needs either a value or a reason")
        return self


class Correlation(FrozenResult):
    """A rank correlation; None when one side is constant. ``note`` warns of a small n."""

    value: float | None = Field(ge=-1.0, le=1.0)
    n: int = Field(ge=2)
    method: str = "Spearman"
    note: str | None = None


def _negated(value: float) -> float:
    return 0.0 - value  # never -0.0


def _shown(value: float, digits: int) -> str:
    text = f"{value:.{digits}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text
