"""Whether a consumer wrote into what a tap gave it."""

from typing import Any

from faultpath.core.arrays import Array, copy, differs, namespace, to_numpy


class Guard:
    """Hands out copies of a tap's values and sees whether somebody wrote into them.

    NumPy arrays are read-only views and need none of this. A tensor tells by its version counter;
    one that keeps none (inference mode) is compared with what it was.
    """

    __slots__ = ("_given", "_mark", "_written")

    def __init__(self) -> None:
        self._given: Array = None
        self._mark: Any = None
        self._written: Any = False

    def hand_out(self, value: Array) -> Array:
        """Return a copy for the consumer, after a look at the last one."""
        self._look()
        self._given = copy(value)
        try:
            self._mark = int(self._given._version)
        except (AttributeError, RuntimeError):
            self._mark = copy(self._given)
        return self._given

    def written(self) -> bool:
        """Return whether a consumer wrote; this waits for the device."""
        self._look()
        return bool(to_numpy(self._written))

    def _look(self) -> None:
        if self._given is None:
            return
        if isinstance(self._mark, int):
            changed = bool(self._given._version != self._mark)
        else:
            unequal = differs(self._given, self._mark)
            changed = namespace(unequal).any(unequal)
        self._written = self._written | changed
