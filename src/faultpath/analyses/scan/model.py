"""The facts and the result of a scan, in numbers."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from faultpath.analyses.facts import Facts
from faultpath.analyses.model import Invalid
from faultpath.analyses.scan.sources import Ranking
from faultpath.core.results import Result
from faultpath.run.findings import Finding
from faultpath.run.question import ScanQuestion
from faultpath.stats.estimate import Sign


class ScanFacts(Facts):
    """Facts of a scan."""

    other: str = ""
    """The only other variant of the system; empty where there are none or several."""


class ScanError(Result, allow_inf_nan=False):
    """An error of one source at one reader, of one sign."""

    source: str
    reader: str
    """The module that gets it."""
    at: tuple[str, ...]
    """Where its fault acts: the module, or some of the places at which that reads."""
    fault: str
    """With its size, without readers."""
    sign: Sign
    """Sign of the first number of its change that is not 0."""
    change: Annotated[tuple[float, ...], Field(min_length=1)]
    """Added to the reading, or fractions of it where `relative`; one number, or a vector."""
    relative: bool
    unit: str
    """Unit of a change that is not relative; empty for a preset of the system."""
    halvings: int = 0
    """How often the size was halved."""

    @property
    def text(self) -> str:
        """The fault with its readers."""
        return f"{self.fault}@{'+'.join(self.at)}"


class FirstStage(Result, allow_inf_nan=False):
    """Effect of an error alone in the first stage; success in percent."""

    error: ScanError
    """With the size that was run."""
    none: float
    alone: float
    loss: float
    """Percentage points, in the scenes that have an outcome with and without it."""
    p_value: float
    """One-sided, not corrected, of "it hurts"."""
    helps_p: float = 1.0
    """Holm's, over all sizes that were run, of "it helps"."""
    acted: bool = True
    """Whether it changed a reading in any trial."""


class SecondStage(Result, allow_inf_nan=False):
    """Effect of an error alone in the second stage; success in percent."""

    error: int
    """Its place among the errors of the scan."""
    kind: Literal["hurts", "helps"] | None
    none: float
    alone: float
    scenes: int
    p_value: float
    corrected_p: float
    helps_p: float


class ScannedPair(Result, allow_inf_nan=False):
    """Effects of two errors, alone and together, in the second stage; success in percent."""

    errors: tuple[int, int]
    kind: Literal["cancel", "covers"] | None
    covering: int | None
    """The error that covers for the other one."""
    worse: int
    none: float
    first: float
    second: float
    both: float
    scenes: int
    regained: float | None
    """Share of the worse one's loss that both together have not."""
    p_value: float
    corrected_p: float | None
    covers_p: float | None

    @property
    def gain(self) -> float:
        """Success with both minus success with the worse one alone, percentage points."""
        return self.both - min(self.first, self.second)


class Together(Result, allow_inf_nan=False):
    """Effect of a source that is wrong at all of its readers, or at all but one, in percent."""

    errors: tuple[int, ...]
    """One a reader that gets it."""
    left_out: str
    """The reader that does not; empty at all of them, as in deployment."""
    none: float
    success: float
    scenes: int


class ScannedVersion(Result):
    """Results of a scan in one variant; each variant is tested by itself."""

    variant: str
    first: tuple[FirstStage, ...]
    """Every size that was run."""
    singles: tuple[SecondStage, ...]
    pairs: tuple[ScannedPair, ...]
    together: tuple[Together, ...]

    @property
    def listed(self) -> tuple[ScannedPair, ...]:
        """The pairs that cancel, and those in which one error covers for the other."""
        return tuple(p for kind in ("cancel", "covers") for p in self.pairs if p.kind == kind)


class ScanResult(Result):
    """Result of a scan in numbers; written as `scan.json`."""

    format: Literal[3] = 3
    question: ScanQuestion
    facts: ScanFacts
    ranking: Ranking
    """All sources that may err, those without a size included."""
    errors: tuple[ScanError, ...]
    """The errors of every source and reader, with the size of the second stage."""
    chosen: tuple[int, ...]
    """Errors that hurt in the first stage and went on, the worst first."""
    scenes: tuple[int, int]
    """Numbers of scenes of the first and of the second stage."""
    trials: int
    versions: Annotated[tuple[ScannedVersion, ...], Field(min_length=1)]
    invalid: Invalid | None = None
    """Why no result follows from these trials."""
    failed: int
    """Trials in which the program raised an error."""
    findings: tuple[Finding, ...] = ()
    """Findings in its trials."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        known = frozenset(range(len(self.errors)))
        texts = {error.text for error in self.errors}
        for version in self.versions:
            together = {place for source in version.together for place in source.errors}
            paired = {place for pair in version.pairs for place in pair.errors}
            alone = {single.error for single in version.singles}
            if not {*self.chosen, *together, *alone} <= known or not paired <= alone:
                raise ValueError("names errors that it does not have")
            if not texts <= {first.error.text for first in version.first}:
                raise ValueError("leaves an error out of the first stage")
            if not all({pair.worse} < {*pair.errors} for pair in version.pairs):
                raise ValueError("has a pair of one error")
        if tuple(version.variant for version in self.versions) != self.question.variants:
            raise ValueError("has other versions than its question")
        conditions = {tuple(s.errors for s in version.together) for version in self.versions}
        if len(conditions) > 1:
            raise ValueError("has other conditions in one version than in the other")
        if not all(source.errors for source in self.versions[0].together):
            raise ValueError("has a source that is wrong nowhere")
        return self
