"""What may watch the taps of a run. What they deliver stays the same to the bit."""

from typing import Any

from faultpath.loop.taps.reading import Query, Reading
from faultpath.loop.taps.tap import Tap


class Observer:
    """Sees what passes the taps of one run; a subclass overrides what it wants to see.

    Readings are those of the run itself: an observer copies what it keeps and writes to nothing.
    """

    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        """See that a consumer got `got` of a reading; of a query, the function that answers."""

    def answered(
        self, tap: Tap, query: Query, step: int, request: Any, answer: Any, got: Any
    ) -> None:
        """See what a query answered to a request, and what the consumer got of that answer."""

    def faulted(self, step: int, held: Any) -> None:
        """See in which scenes a fault was in force at some tap: a bool, or a bool array `[B]`."""
