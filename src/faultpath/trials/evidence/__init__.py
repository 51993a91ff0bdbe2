"""Evidence measured on recorded windows: what was asked, what was found, and where it is kept.

No tensors and no simulator here: a system measures, and everybody else reads the table.
"""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Literal, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

Quantity: TypeAlias = Literal[
    "position-error", "position-response", "acceleration-error", "wind-term-error"
]

QUANTITIES: Mapping[Quantity, str] = MappingProxyType(
    {
        "position-error": "m",
        "position-response": "m",
        "acceleration-error": "m/s^2",
        "wind-term-error": "m/s^2",
    }
)
"""Unit of each quantity. `docs/design/evidence.md` gives their formulas."""


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Recording(_Frozen):
    """Closed-loop flights under correct inputs, whose windows are measured.

    Which scenes of the library fly is said when they are measured: the first N.
    """

    library: str
    """Name of a library, or the path of its file."""
    variant: str
    """Variant that flies."""
    seed: int = 0
    options: dict[str, str] = {}
    """Options of the system, as in `SystemSpec`."""

    @property
    def name(self) -> str:
        """Return a readable name of its own, such as `held-out:true-parameter:0:wind-L3`."""
        parts = [self.library, self.variant, str(self.seed)]
        if self.options:
            parts.append(",".join(f"{key}-{value}" for key, value in sorted(self.options.items())))
        return ":".join(parts)

    def __hash__(self) -> int:
        """Hash by name, since options have no hash."""
        return hash(self.name)


class Measurement(_Frozen):
    """A quantity of one variant on the windows of a recording, window by window."""

    recording: Recording
    quantity: Quantity
    subject: str
    """Variant that is measured: a predictor and what feeds its wind input, as in arms."""
    seed: int = 0
    """Seed of the training of what the variant names, and of the faults' random numbers."""
    faults: tuple[str, ...] = ()
    """Faults as the command line writes them, for example `calibration=+0.1@predictor`."""

    def key(self) -> str:
        """Content hash: equal measurements have equal keys, on every machine."""
        content = json.dumps(self.model_dump(mode="json"), sort_keys=True)
        return hashlib.sha256(content.encode()).hexdigest()[:16]

    def __hash__(self) -> int:
        """Hash by content, as `key`."""
        return hash(self.key())


Progress: TypeAlias = Callable[[float, float], None]
"""Called with the work done and all of it, in flights; a measurement counts as a part of one."""


@dataclass(frozen=True, eq=False)
class Measured:
    """One measurement: its W windows in the order of their scenes, then of their time."""

    scenes: tuple[str, ...]
    """Id of the scene that each window was recorded in, `[W]`."""
    steps: NDArray[np.int64]
    """Control step of each window's present, `[W]`."""
    values: NDArray[np.float64]
    """The quantity, `[W]`, in the unit that `QUANTITIES` gives."""

    def __post_init__(self) -> None:
        shapes = {(len(self.scenes),), self.steps.shape, self.values.shape}
        if len(shapes) > 1:
            raise ValueError(f"scenes, steps and values are of the same windows, not of {shapes}")

    def __len__(self) -> int:
        return len(self.scenes)

    def same_windows(self, other: "Measured") -> bool:
        """Return whether both are of the same windows in the same order, so that they pair."""
        return self.scenes == other.scenes and np.array_equal(self.steps, other.steps)


@dataclass(frozen=True, eq=False)
class EvidenceTable:
    """Everything that was measured, by measurement."""

    entries: Mapping[Measurement, Measured]

    def values(self, measurement: Measurement) -> Measured:
        """Return what was measured; `KeyError` when the table does not have it."""
        return self.entries[measurement]

    def __contains__(self, measurement: object) -> bool:
        return measurement in self.entries

    def __iter__(self) -> Iterator[Measurement]:
        return iter(self.entries)

    def __len__(self) -> int:
        return len(self.entries)


class Measurer(Protocol):
    """How a system measures: `trials.registry.load_measurer` gives the one of a system."""

    def __call__(
        self,
        measurements: Sequence[Measurement],
        scenes: int | None,
        folder: Path,
        workers: int = 0,
        progress: Progress | None = None,
    ) -> EvidenceTable:
        """Record what is missing, measure what is missing, and return all of `measurements`.

        Args:
            measurements: What to measure; one that stands there twice is measured once.
            scenes: The first N scenes of each library; `None`: all.
            folder: Where recordings and measurements are kept, so that the next call goes on.
            workers: Processes; 0: everything is done in this one.
            progress: Is told how far it is.

        Raises:
            UserError: A library, variant, option or fault does not exist or does not fit.
        """
        ...
