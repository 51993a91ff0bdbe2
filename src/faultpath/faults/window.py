"""When a fault is in force, scene by scene."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from faultpath.arrays import Array, namespace, place


@dataclass(frozen=True)
class Window:
    """From `onset` up to `end`, then `recovery` steps of linear return to the clean reading.

    `onset` and `end` are ints for all scenes, or both int arrays `[B]`; an `end` of `None` never
    comes.
    """

    onset: Any
    end: Any
    recovery: int

    @cached_property
    def uniform(self) -> bool:
        """Whether all scenes share one window, so that the host knows what is in force."""
        return isinstance(self.onset, int)

    def beside(self, reading: Array) -> "Window":
        """Return the window with its arrays in the namespace and on the device of `reading`."""
        if self.uniform:
            return self
        end = None if self.end is None else place(self.end, reading)
        return Window(place(self.onset, reading), end, self.recovery)

    def over(self, step: int) -> bool:
        """Return whether nothing is in force any more, so far as the host can tell."""
        return self.uniform and self.end is not None and step >= self.end + self.recovery

    def weight(self, step: int) -> Any:
        """Return the share of the fault in the value: 1 in the window, 0 outside, between after it.

        A float for all scenes, or a float64 array `[B]`. In recovery step k = 1 … n it is
        1 - k / (n + 1), so the reading is clean again in step n + 1.
        """
        if self.uniform:
            if step < self.onset:
                return 0.0
            if self.end is None:
                return 1.0
            return min(max((self.recovery - (step - self.end)) / (self.recovery + 1), 0.0), 1.0)
        xp = namespace(self.onset)
        begun = xp.astype(step >= self.onset, xp.float64)
        if self.end is None:
            return begun
        left = xp.astype(self.recovery - (step - self.end), xp.float64) / (self.recovery + 1)
        return begun * xp.clip(left, 0.0, 1.0)
