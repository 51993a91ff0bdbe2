"""The record of a map: what was flown, what is decided, and how it is said."""

from pydantic import Field

from faultpath.core.results import Result
from faultpath.decisions.map.asked import MapQuestion
from faultpath.statistics import Sign


class MapPoint(Result, allow_inf_nan=False):
    """A pair of errors that was flown; differences are repair minus baseline, pp."""

    errors: tuple[float, float]
    baseline_percent: float
    repair_percent: float
    difference: float
    low: float
    high: float
    """Ends of the interval that holds at all points at once."""
    sign: Sign
    """The side that is decided, with the map's multiplicity."""
    won: int
    lost: int
    """Scenes that go to the repair and to the baseline, over the seeds."""


class MapSurface(Result, allow_inf_nan=False):
    """The surface on an even lattice: rows upward, by the error at the second module."""

    sizes: tuple[float, ...]
    difference: tuple[tuple[float, ...], ...]
    sign: tuple[tuple[Sign, ...], ...]
    """Where it is decided who is ahead; the zero contour lies where it is not."""


class Flip(Result, allow_inf_nan=False):
    """On one path, in one direction of the error: how large an error changes the verdict."""

    path: str
    """A module, or `shared`."""
    direction: Sign
    start: Sign
    """What is decided under correct inputs."""
    turned: Sign
    """What is decided between `first` and `last`: the other side, or either where `start` is 0."""
    until: float | None
    """Largest error up to which the verdict under correct inputs stays decided."""
    estimate: float | None
    """Smallest error at which the estimate has the other sign than under correct inputs."""
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
    """Correlations at which it is decided who is ahead."""

    low: float
    high: float
    sign: Sign


class JointErrors(Result, allow_inf_nan=False):
    """The expected difference under the joint distribution, over all correlations."""

    curve: tuple[Expectation, ...]
    asked: tuple[Expectation, ...]
    """At the correlations 0 and 1, and at the one that was asked for."""
    estimates: tuple[float, ...]
    """Where the estimate crosses zero: the break-even correlation, if there is just one."""
    undecided: tuple[tuple[float, float], ...]
    """A 95 % confidence set for the break-even correlation."""
    regions: tuple[CorrelationRegion, ...]
    outside: float = Field(ge=0, le=1)
    """Largest share of the distribution beyond the map; it counts as at the map's edge."""
    critical: float


class MapRecord(Result, allow_inf_nan=False):
    """A map, decided."""

    format: int = 1
    question: MapQuestion
    scenes: int
    """Compared: those without a void pair at any point."""
    points: tuple[MapPoint, ...]
    surface: MapSurface
    flips: tuple[Flip, ...]
    joint: JointErrors
    critical: float
    """Critical value of a standard normal that holds over the whole map."""
    failed: int
    """Trials in which the program raised an error; each voids its scene at every point."""
    estimand: str
    headline: str
    sentences: tuple[str, ...]
    findings: tuple[str, ...] = ()
