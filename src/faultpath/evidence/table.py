"""What was measured, window by window."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.evidence.model import Measurement

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
