"""The question and the record of a sensitivity analysis."""

from typing import Literal

from faultpath.core.results import Frozen, Result
from faultpath.decisions.question import Resolved
from faultpath.interface import Uncertainty

_NOTHING = 0.005
"""Share of the variance that counts as nothing."""


class UncertainSource(Frozen, allow_inf_nan=False):
    """A source of a group, and how large its error is."""

    source: str
    channels: tuple[str, ...]
    """Those that it feeds in the variant."""
    error: Uncertainty


class Uncertain(Frozen):
    """Sources that err together: those of one correlation group, or one alone."""

    name: str
    parts: tuple[UncertainSource, ...]
    numbers: int
    """Drawn for an error: 1 where all have one cause, or one for each component of a vector."""


class ResolvedSensitivity(Resolved, allow_inf_nan=False):
    """Question of a sensitivity analysis, as its record keeps it."""

    variant: str
    groups: tuple[Uncertain, ...]
    left_out: tuple[str, ...]
    """Sources that the variant reads and that declare no error."""
    metric: str
    """Empty for success."""
    said: str
    """Name of the outcome that is explained, in words."""
    unit: str
    points: int
    design_seed: int
    library: str
    library_hash: str
    n_scenes: int
    seeds: tuple[int, ...]


class Index(Frozen):
    """A share of the variance, with the interval that holds for all indices at once."""

    value: float
    low: float
    high: float

    @property
    def counts(self) -> bool:
        """Whether it is decided to be more than what reads as 0 %."""
        return self.low > _NOTHING


class Indices(Result):
    """Contribution of a group."""

    group: str
    first: Index
    """Index of the group alone."""
    total: Index
    """Index of the group, alone and with others."""


class SensitivityRecord(Result, allow_inf_nan=False):
    """A sensitivity analysis; written as `sensitivity.json`."""

    format: Literal[1] = 1
    question: ResolvedSensitivity
    values: tuple[float, ...]
    """Outcome at each row of the design: the mean over scenes and seeds."""
    scenes: int
    """In which every trial of the design ran to its end."""
    indices: tuple[Indices, ...]
    """In the order of the question; empty where nothing varies."""
    level: float
    """Level of each interval, such that all hold at once in about 95 % of analyses."""
    failed: int
    headline: str = ""
    sentences: tuple[str, ...] = ()
    findings: tuple[str, ...] = ()
