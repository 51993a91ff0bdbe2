"""The decision record: what was asked, what came out, and what it means."""

from pydantic import BaseModel, ConfigDict

from faultpath.statistics import BreakEven, Estimate


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Question(_Frozen):
    """What the audit asked."""

    system: str
    options: dict[str, str]
    baseline: str
    repair: str
    fault: str
    """The fault in words, as given on the command line."""
    library: str
    library_hash: str
    n_scenes: int
    seeds: tuple[int, ...]


class StruckTap(_Frozen):
    """A tap at which a fault was in force, by its receipts: all scenes and seeds together."""

    channel: str
    consumer: str
    struck_steps: int
    """Control steps with a fault in force while the scene ran."""
    altered_steps: int
    """Those in which what the consumer got differed from the reading."""


class Path(_Frozen):
    """One way in which the fault reaches the system."""

    name: str
    """`correct`, the name of the only module struck, or `shared`."""
    title: str
    consumers: tuple[str, ...]
    """Taps struck in the repaired system; empty for `correct`."""
    baseline_consumers: tuple[str, ...]
    """Taps struck in the baseline. Where the baseline has no such consumer the fault cannot reach
    it, and its trials under correct inputs stand in."""
    struck: tuple[StruckTap, ...] = ()
    """What was struck in the repaired system: from receipts, where `consumers` is the plan."""
    baseline_struck: tuple[StruckTap, ...] = ()
    """What was struck in the baseline."""


class Cell(_Frozen):
    """The trials of one variant on one path, all seeds together."""

    variant: str
    path: str
    trials: int
    success: int
    crash: int
    timeout: int
    failed: int
    success_percent: float
    median_time_s: float | None
    """Over successful trials; `None` without one."""
    struck_trials: int
    altered_trials: int


class Effect(_Frozen):
    """The repair minus the baseline on one path, over pairs that both ran."""

    path: str
    success: Estimate
    """Percentage points."""
    pairs: int
    void_pairs: int
    wins: tuple[int, ...]
    """Scenes where only the repair succeeded, one count a seed."""
    losses: tuple[int, ...]
    test: str
    p_value: float
    mid_p_value: float | None
    minimum_detectable_pp: float | None
    detected: bool
    time_s: Estimate | None
    """On jointly successful pairs; `None` without one."""
    joint_successes: int
    terminal_distance_m: Estimate | None
    min_clearance_m: Estimate | None
    words: str


class PathBreakEven(_Frozen):
    """The fault frequency above which the repair pays on one path."""

    path: str
    result: BreakEven
    curve: tuple[tuple[float, float, float, float], ...]
    """`(p, expected difference, low, high)` in fractions and percentage points, from the joint
    bootstrap; for the picture of expected difference against fault frequency."""


class Reversal(_Frozen):
    """Whether the verdict on one isolated path turns round when the fault is shared."""

    isolated: str
    shared: str
    change: Estimate
    """Effect under the shared fault minus effect under the isolated one, percentage points."""
    reversed: bool
    """The interval of the change excludes 0 and the two effects differ in sign."""
    words: str


class Verdict(_Frozen):
    """The answer in words."""

    headline: str
    sentences: tuple[str, ...]
    would_change: tuple[str, ...]
    """What would change the verdict."""


class DecisionRecord(_Frozen):
    """Everything that tables, pictures and the report show; written as `record.json`."""

    format: int = 1
    question: Question
    paths: tuple[Path, ...]
    cells: tuple[Cell, ...]
    effects: tuple[Effect, ...]
    break_even: tuple[PathBreakEven, ...]
    reversals: tuple[Reversal, ...]
    verdict: Verdict
    findings: tuple[str, ...] = ()
    """What the run found that a reader has to know, a sentence each: pairs of different conditions,
    results that do not repeat or depend on their block, consumers that never read."""
