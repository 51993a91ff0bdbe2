"""The result of an audit in numbers."""

from collections.abc import Sequence
from typing import Literal

from faultpath.analyses.effects import Change, Effect, Secondary
from faultpath.analyses.facts import ComparisonFacts, EarlierAnalysis, Question
from faultpath.core.results import Result
from faultpath.core.text import capital
from faultpath.run.findings import Finding, Recheck, Unpaired, Unrepeated
from faultpath.stats.estimate import BreakEven

CORRECT = "correct"
SHARED = "shared"
AS_RUN = "as-run"
"""The only condition of results that name no condition; no module can be called so."""
Invalid = Literal["unrepeatable", "unpaired"]
"""Trials that came out otherwise when they ran again; pairs that met different conditions."""


def where(condition: str) -> str:
    """Return a condition as part of a sentence."""
    if condition == CORRECT:
        return "under correct inputs"
    if condition == AS_RUN:
        return "in these results"
    return (
        "under the shared fault"
        if condition == SHARED
        else f"with the fault at the {condition} alone"
    )


def title_of(condition: str) -> str:
    """Return the title of a condition."""
    titles = {CORRECT: "Correct inputs", SHARED: "Shared fault", AS_RUN: "The results"}
    return titles.get(condition, f"{capital(condition.replace('_', ' '))} only")


def invalid_by(findings: Sequence[Finding]) -> Invalid | None:
    """Return why no result follows from trials with these findings; `None` where one does."""
    if any(isinstance(f, Unrepeated) or (isinstance(f, Recheck) and f.deviation) for f in findings):
        return "unrepeatable"
    return "unpaired" if any(isinstance(f, Unpaired) for f in findings) else None


class FaultedTap(Result):
    """A tap at which a fault was in force, by the delivery log: all scenes and seeds together."""

    channel: str
    reader: str
    faulted_steps: int
    """Control steps with a fault in force while the scene ran."""
    altered_steps: int
    """Those in which what the reader got differed from the reading."""


class Condition(Result):
    """One way in which the fault reaches the system."""

    name: str
    """`correct`, the name of the only faulted module, or `shared`."""
    title: str
    readers: tuple[str, ...]
    """Taps faulted in the repaired system; empty for `correct`."""
    baseline_readers: tuple[str, ...]
    """Taps faulted in the baseline. Where the baseline has no such reader the fault cannot reach
    it, and its trials under correct inputs stand in."""
    faulted: tuple[FaultedTap, ...] = ()
    """Taps faulted in the repaired system: from the delivery log, where `readers` is the plan."""
    baseline_faulted: tuple[FaultedTap, ...] = ()
    """Taps faulted in the baseline."""


class VariantCounts(Result):
    """The trials of one variant under one condition, all seeds together."""

    variant: str
    condition: str
    trials: int
    success: int
    crash: int
    timeout: int
    failed: int
    success_percent: float
    median_time_s: float | None
    """Over successful trials; `None` without one."""
    faulted_trials: int
    altered_trials: int


class Ahead(Result):
    """Part of a share, of faulty episodes or of common causes, in which a version is ahead."""

    sign: Literal[-1, 1]
    where: Literal["everywhere", "many", "few", "from", "up to"]
    """`many` and `few`: at that end of the range, as far as is open."""
    percent: int | None = None
    """Whole percentage of `from` and `up to`."""


Share = Literal["frequency", "beta"]
"""The share of episodes with the fault, or of the faults of an isolated condition's module that
reach all modules at once: the beta factor."""


class ConditionBreakEven(Result):
    """The shares at which neither variant is significantly ahead, under one condition."""

    condition: str
    over: Share
    result: BreakEven
    curve: tuple[tuple[float, float, float, float], ...]
    """`(share, expected difference, low, high)` in fractions and percentage points. The band
    touches 0 exactly where the share is in the set of `result`."""
    ahead: tuple[Ahead, ...]
    """Ranges of the share at which a version is ahead; empty where no end has an effect that
    leads."""


class Testing(Result):
    """Common test of the effects and changes of an audit."""

    hypotheses: int
    """Number of contrasts that share the error rate of 5 %."""
    scenes_needed: int
    """With fewer, nothing can be significant, whatever comes out."""
    intervals: str
    """Method of the effects' intervals."""


class StoppedAudit(Result):
    """End of a sequential audit."""

    scenes: int
    """Scenes that were run; missing pairs included."""
    reached: bool
    """Whether it stopped as its question says, and not because scenes ran out."""
    small: tuple[str, ...]
    """Conditions on which the difference was shown to be smaller than the margin."""


class AuditResult(Result):
    """Result of an audit in numbers; written as `record.json`."""

    format: Literal[7] = 7
    question: Question
    facts: ComparisonFacts
    conditions: tuple[Condition, ...]
    counts: tuple[VariantCounts, ...]
    """Under each condition those of the baseline, then those of the repair."""
    effects: tuple[Effect, ...]
    changes: tuple[Change, ...]
    secondary: tuple[Secondary, ...] = ()
    """Under each condition that has an effect."""
    break_evens: tuple[ConditionBreakEven, ...]
    """Over the frequency of the fault under each condition but that of correct inputs, and over the
    beta factor under each isolated one."""
    scenes: int
    """Scenes that are compared: the most that any effect rests on."""
    invalid: Invalid | None = None
    """Why no result follows from these trials: then nothing is significant."""
    testing: Testing
    findings: tuple[Finding, ...] = ()
    """Findings in its trials, beside what follows from the fields above."""
    stopped: StoppedAudit | None = None
    """State at which a sequential audit ended."""
    earlier: tuple[EarlierAnalysis, ...] = ()
    """Earlier analyses of the same trials with another question."""

    @property
    def few(self) -> bool:
        """Whether there are too few scenes for anything to be significant."""
        return self.scenes < self.testing.scenes_needed

    @property
    def break_even(self) -> tuple[ConditionBreakEven, ...]:
        """Those over the frequency of the fault."""
        return tuple(shares for shares in self.break_evens if shares.over == "frequency")

    @property
    def break_even_beta(self) -> tuple[ConditionBreakEven, ...]:
        """Those over the beta factor."""
        return tuple(shares for shares in self.break_evens if shares.over == "beta")

    @property
    def titles(self) -> dict[str, str]:
        """Title of each condition, by its name."""
        return {condition.name: condition.title for condition in self.conditions}

    def effect(self, condition: str) -> Effect | None:
        """Return the effect under a condition; `None` where it has none."""
        return next((effect for effect in self.effects if effect.condition == condition), None)

    def winner(self, sign: int) -> str:
        """Return the variant of a side."""
        return self.question.repair if sign > 0 else self.question.baseline

    def is_small(self, effect: Effect) -> bool:
        """Whether an effect was shown to be smaller than the margin of a sequential audit."""
        return self.stopped is not None and effect.condition in self.stopped.small
