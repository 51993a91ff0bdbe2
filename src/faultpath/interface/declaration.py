"""The declaration of the information that a system's modules read.

Terms follow the paper, section "A Framework for Auditing Information Interfaces": a channel
conditions a module; its source, its readers and its deployment conditions (latency, rate, error
correlation) are recorded; a gap is one of fidelity (an estimate replaces the truth) or of
availability (a channel that the trained module expects is missing).
"""

from enum import StrEnum
from typing import Annotated, Self, cast

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    PlainSerializer,
    StringConstraints,
    model_validator,
)

from faultpath.core.arrays import Constant
from faultpath.core.results import Frozen
from faultpath.core.text import has_control_characters

Name = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]*$")]
Reader = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]*\.[a-z][a-z0-9_]*$")]


def _readable(text: str) -> str:
    """Refuse control characters, which files may lose and terminals execute."""
    for character in text:
        if character != "\n" and has_control_characters(character):
            raise ValueError(f"holds the control character U+{ord(character):04X}")
    return text


def _several(names: object) -> object:
    if isinstance(names, str):
        return (names,)
    return tuple(cast("list[object]", names)) if isinstance(names, list) else names


def _briefly(names: tuple[str, ...]) -> str | list[str]:
    return names[0] if len(names) == 1 else list(names)


SourceNames = Annotated[
    tuple[Name, ...],
    Field(min_length=1),
    BeforeValidator(_several, json_schema_input_type=Name | tuple[Name, ...]),
    PlainSerializer(_briefly, when_used="json"),
]
"""Sources that a module produces."""

Words = Annotated[str, AfterValidator(_readable)]
"""Text for people: line breaks, but no other control characters."""


class Provenance(StrEnum):
    """Origin of a source's numbers."""

    MEASURED = "measured"
    ESTIMATED = "estimated"
    RECONSTRUCTED = "reconstructed"
    """The output of a module of the system, which has inputs of its own."""
    PRIVILEGED = "privileged"
    """Known to the simulator only; not available at deployment."""
    INTERNAL = "internal"
    """A value inside the one module that reads it, exposed so that faults can act on it."""
    CONSTANT = "constant"
    COMMANDED = "commanded"


class Gap(StrEnum):
    """A channel's loss at deployment, relative to accurate input."""

    NONE = "none"
    FIDELITY = "fidelity"
    AVAILABILITY = "availability"


class Uncertainty(Frozen, allow_inf_nan=False):
    """Expected error of a source at deployment: a standard deviation or a half-range.

    In the source's unit, or as a fraction of its value when `relative`.
    """

    std: float | None = Field(default=None, ge=0)
    half_range: float | None = Field(default=None, ge=0)
    """Half the width of a uniform distribution around the true value."""
    relative: bool = False
    words: Words = ""

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if (self.std is None) == (self.half_range is None):
            raise ValueError("give either std or half_range")
        return self

    @property
    def expected_std(self) -> float:
        """Standard deviation; for a half-range h it is h / sqrt(3)."""
        if self.std is not None:
            return self.std
        return (self.half_range or 0.0) / 3**0.5


class Source(Frozen, allow_inf_nan=False):
    """A producer of a reading at every step."""

    name: Name
    unit: Words
    """`1` for a number without a unit."""
    shape: tuple[Annotated[int, Field(ge=1)], ...] = ()
    """Shape of one scene's reading; `()` for a scalar."""
    provenance: Provenance
    latency_s: float = Field(default=0.0, ge=0)
    rate_hz: float | None = Field(default=None, gt=0)
    """`None`: sampled at every control step."""
    uncertainty: Uncertainty | None = None
    scale: float | None = Field(default=None, gt=0)
    """Typical magnitude in `unit`, to compare an absolute uncertainty with others."""
    correlation_group: Name | None = None
    """Sources of one group have one cause of error."""
    description: Words = ""

    @property
    def expected_uncertainty(self) -> float | None:
        """Expected standard deviation as a fraction of the typical value; `None` if unknown."""
        if self.uncertainty is None:
            return None
        if self.uncertainty.relative:
            return self.uncertainty.expected_std
        return None if self.scale is None else self.uncertainty.expected_std / self.scale


class Channel(Frozen, allow_inf_nan=False):
    """A source as readers see it."""

    name: Name
    sources: tuple[Name, ...] = Field(min_length=1)
    """Possible sources of the channel; the first is used at deployment."""
    readers: tuple[Reader, ...] = Field(min_length=1)
    """Every place that reads the channel, as `module.place`."""
    erasure_default: Constant = 0.0
    """Value that a reader gets when the channel is erased."""
    gap: Gap = Gap.NONE
    description: Words = ""
