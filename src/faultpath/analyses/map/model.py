"""The facts and the result of a map."""

from typing import Literal, Self

from pydantic import Field, model_validator

from faultpath.analyses.facts import Facts
from faultpath.analyses.map.lattice import UNITS
from faultpath.analyses.model import Invalid
from faultpath.core.results import Result
from faultpath.run.findings import Finding
from faultpath.run.question import MapQuestion
from faultpath.stats.estimate import Sign


class MapFacts(Facts, allow_inf_nan=False):
    """Facts of a map, with the defaults that follow from system and library."""

    n_scenes: int
    modules: tuple[str, str]
    """The modules at which the error acts: across and upward in the picture."""
    others: tuple[str, ...] = ()
    """Readers of the same source that get it without error."""
    up_to: float = Field(gt=0)
    """The largest error, of either sign."""
    relative: bool
    """Whether errors are fractions of the reading; else they are in `unit`."""
    unit: str
    means: tuple[float, float]
    spreads: tuple[float, float]
    """Standard deviations of the joint distribution."""

    def size(self, units: int) -> float:
        """Return an error from a coordinate of a point."""
        return round(self.up_to * units / UNITS, 12) + 0.0


class MapPoint(Result, allow_inf_nan=False):
    """A pair of errors that was run; differences are repair minus baseline, pp."""

    errors: tuple[float, float]
    baseline_percent: float
    repair_percent: float
    difference: float
    low: float
    high: float
    """Ends of the interval that holds at all points at once."""
    sign: Sign
    """The side that is significantly ahead, corrected for all points of the map."""
    won: int
    lost: int
    """Scenes that go to the repair and to the baseline, over the seeds."""


class MapSurface(Result, allow_inf_nan=False):
    """The surface on an even lattice: rows upward, by the error at the second module."""

    sizes: tuple[float, ...]
    difference: tuple[tuple[float, ...], ...]
    sign: tuple[tuple[Sign, ...], ...]
    """Where the interpolated difference leaves out 0, but for the error of interpolating it."""

    @model_validator(mode="after")
    def _square(self) -> Self:
        rows = (self.difference, self.sign, *self.difference, *self.sign)
        if {len(self.sizes)} != set(map(len, rows)):
            raise ValueError("has not a row and a column for each size")
        return self


class Flip(Result, allow_inf_nan=False):
    """On one condition, in one direction of the error: at which of the sizes that were run the
    ranking is reversed."""

    condition: str
    """A module, or `shared`."""
    direction: Sign
    start: Sign
    """Side significantly ahead under correct inputs."""
    turned: Sign
    """Side significantly ahead from `first` to `last`: the other one, or either where `start` is
    0."""
    until: float | None
    """Largest error up to which the side `start` stays significantly ahead."""
    estimate: float | None
    """Smallest error at which the interpolated estimate has the other sign than under correct
    inputs."""
    first: float | None
    last: float | None


class Expectation(Result, allow_inf_nan=False):
    """The expected difference at one correlation, pp."""

    correlation: float
    value: float
    low: float
    high: float
    sign: Sign


class CorrelationRegion(Result, allow_inf_nan=False):
    """Correlations at which one side is significantly ahead."""

    low: float
    high: float
    sign: Sign


class JointErrors(Result, allow_inf_nan=False):
    """The expected difference under the joint distribution, over all correlations: of the surface
    interpolated between the points, whose error no interval here includes."""

    curve: tuple[Expectation, ...]
    requested: tuple[Expectation, ...]
    """At the correlations 0 and 1, and at the requested one."""
    estimates: tuple[float, ...]
    """Where the estimate crosses zero: the break-even correlation, if there is just one."""
    undecided: tuple[tuple[float, float], ...]
    """A 95 % confidence set for the break-even correlation."""
    regions: tuple[CorrelationRegion, ...]
    outside: float = Field(ge=0, le=1)
    """Largest share of the distribution beyond the map; it counts as at the map's edge."""
    critical: float


class MapResult(Result, allow_inf_nan=False):
    """Result of a map in numbers; written as `map.json`."""

    format: Literal[4] = 4
    question: MapQuestion
    facts: MapFacts
    scenes: int
    """Compared: those without a missing pair at any point."""
    invalid: Invalid | None = None
    """Why no result follows from these trials: then nothing is significant."""
    points: tuple[MapPoint, ...]
    surface: MapSurface
    flips: tuple[Flip, ...]
    joint: JointErrors
    critical: float
    """Critical value of a standard normal that holds over the whole map."""
    failed: int
    """Trials in which the program raised an error; each leaves its scene out at every point."""
    findings: tuple[Finding, ...] = ()
    """Findings in its trials."""

    def winner(self, sign: int) -> str:
        """Return the variant of a side."""
        return self.question.repair if sign > 0 else self.question.baseline
