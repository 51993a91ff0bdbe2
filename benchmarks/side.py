"""One side of a comparison: work that can be repeated, in a process of its own."""

from abc import ABC, abstractmethod
from collections.abc import Sequence


class Side(ABC):
    """Work that is timed. `import_path(**arguments)` builds it in the child process."""

    amount: float = 1.0
    """Units of work in one repetition; a rate is amount times repetitions over seconds."""

    def prepare(self) -> None:  # noqa: B027, most work needs no preparation
        """Get ready for the next repetition; this is not timed."""

    @abstractmethod
    def work(self) -> None:
        """Do the work once."""

    def answer(self) -> Sequence[float]:
        """Return numbers that another side must reproduce; empty where nothing is comparable."""
        return ()
