"""Differences between two versions: effects, changes, and what stands beside them."""

from typing import Literal

from pydantic import Field

from faultpath.core.results import Result
from faultpath.stats.decisions import Turn
from faultpath.stats.distributions import sign_p_value
from faultpath.stats.estimate import EM, Estimate, Sign

FLOOR_PERCENT, CEILING_PERCENT = 10.0, 90.0
Extreme = Literal["floor", "ceiling"]
"""Both versions below the one, or both above the other."""


class Missing(Result):
    """Pairs without both outcomes, and the range of an effect that they leave open."""

    void: int = 0
    """Missing pairs, seed by seed: a trial failed, or the two are no pair."""
    repair: int = 0
    """Failed trials of the repair under this condition."""
    baseline: int = 0
    against_pp: float | None = None
    """The difference over all scenes where all trials that failed go against the repair; `None`
    where none failed under any condition."""
    favour_pp: float | None = None
    """The same where they go for it."""
    uneven: bool = False
    """Whether one version failed more often than chance explains: no headline rests on it."""
    unsettled: bool = False
    """Whether it would be significant, if failed trials could not undo that."""
    reruns: tuple[int, int] | None = None
    """If so: how many failed trials of the repair and of the baseline have to run to make it
    significant, if they come out as the others did."""


class AtThreshold(Result):
    """Success under another rule: the trial did not crash, and its metric is good enough."""

    threshold: float
    baseline_percent: float
    repair_percent: float
    difference: Estimate
    """Percentage points; secondary, with an interval that stands by itself."""


class Difference(Result):
    """A difference in success with its interval and its test, corrected over the family."""

    value: float
    """Percentage points."""
    low: float | None
    """Lower end of the 95 % interval."""
    high: float | None
    per_seed: tuple[float, ...]
    """The same from each seed alone, of those with a complete pair."""
    scenes: int
    """Scenes that it rests on: those of which a pair has both outcomes with any seed."""
    test: str
    p_value: float
    corrected_p: float | None
    """Over the family, after Holm or by the shares of a sequential audit; `None` outside of it."""
    sign: Sign
    """Side significantly ahead, corrected over the family: 1 for the repair, -1 for the baseline, 0
    for neither."""

    @property
    def significant(self) -> bool:
        """Whether one of the versions is significantly ahead."""
        return self.sign != 0

    @property
    def interval(self) -> tuple[float, float] | None:
        """Both ends, where there are any."""
        return None if self.low is None or self.high is None else (self.low, self.high)


class Effect(Difference):
    """The repair minus the baseline under one condition, over the scenes of which a pair ran."""

    condition: str
    won: tuple[tuple[int, int], ...]
    """Seed by seed: scenes in which only the repair succeeded, and those in which only the baseline
    did."""
    ahead: tuple[int, int]
    """Scenes in which the repair succeeded with more seeds than the baseline, and those in which
    the baseline did."""
    rates: tuple[float, float]
    """Success of baseline and repair over the pairs that are compared, percent."""
    missing: Missing | None = None
    """Where pairs are missing; with bounds where trials failed under any condition."""
    least_pp: float | None
    """True difference that is significant with 80 % power, if it comes on top of the discordance
    that was seen."""

    @property
    def acted(self) -> bool:
        """Whether the fault changed anything in any trial; else nothing was tested. Correct inputs
        count as so."""
        return self.corrected_p is not None

    @property
    def mcnemar_p(self) -> float | None:
        """P-value of exact McNemar, to stand beside that of another test of one seed."""
        return sign_p_value(*self.won[0]) if self.test.startswith(EM) else None

    @property
    def leads(self) -> bool:
        """Whether a headline may rest on it: significant, away from floor and ceiling, and not
        among trials that one version survived."""
        return self.sign != 0 and self.extreme is None and not self.uneven

    @property
    def extreme(self) -> Extreme | None:
        """Where both versions are at the floor or at the ceiling; this makes no headline."""
        rates = [round(rate, 9) for rate in self.rates]  # sums of thirds miss 90 in the last bit
        if min(rates) > CEILING_PERCENT:
            return "ceiling"
        return "floor" if max(rates) < FLOOR_PERCENT else None

    @property
    def void(self) -> int:
        """Missing pairs, seed by seed."""
        return self.missing.void if self.missing else 0

    @property
    def uneven(self) -> bool:
        """Whether one version's trials failed more often than chance explains."""
        return self.missing is not None and self.missing.uneven

    @property
    def unsettled(self) -> bool:
        """Whether it would be significant, if failed trials could not undo that."""
        return self.missing is not None and self.missing.unsettled


class Change(Difference):
    """Change of the effect from a fault at one module to the shared one."""

    isolated: str
    unsettled: bool = False
    """Whether it would be significant, if failed trials could not undo that."""
    turn: Turn
    """`reversal`: both effects are significant, with opposite signs. `interaction`: the change
    alone is."""


class Secondary(Result):
    """Time and metrics under one condition, repair minus baseline, without tests."""

    condition: str
    time_s: Estimate | None = None
    """On jointly successful scenes."""
    joint_successes: int = 0
    metrics: dict[str, Estimate] = Field(default_factory=dict[str, Estimate])
    """Difference in each metric that all trials have."""
    metric_means: tuple[float, float] | None = None
    """Means of the question's metric: baseline and repair."""
    thresholds: tuple[AtThreshold, ...] = ()
    """For each of the question's thresholds."""
