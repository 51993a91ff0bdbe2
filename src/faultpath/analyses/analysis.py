"""Parts that audit, map and scan share: rounds of trials, and a result."""

from abc import ABC, abstractmethod
from collections.abc import Generator
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar

from faultpath.run.deliveries import Deliveries
from faultpath.run.execution.state import Stop
from faultpath.run.plan import Plan
from faultpath.run.question import Request
from faultpath.run.trials import Trials
from faultpath.system.system import System

Items = TypeVar("Items")


@dataclass(frozen=True)
class Round:
    """Trials of one round, those of earlier rounds included."""

    plan: Plan
    items: int = 1
    """So many of what the analysis adds from round to round."""
    most: int = 1
    """So many are expected in the end."""
    notice: str = ""
    """Sentence to be shown before the round."""
    stop: Stop | None = None
    """Asked at each analysis of a sequential plan."""


Rounds: TypeAlias = Generator[Round, Trials, Items]
"""Rounds, each from the trials of those before; they return all that they added."""


@dataclass(frozen=True)
class Analysis(ABC, Generic[Items]):
    """A question, the rounds of trials that answer it, and the result that follows from them."""

    noun: ClassVar[str] = ""
    """Plural of that which rounds add; empty for an analysis of one round."""

    question: Request
    system: System
    named: tuple[str, ...]
    """Parts of the name of its folder; system options, scenes and seeds follow."""

    @abstractmethod
    def rounds(self) -> Rounds[Items]:
        """Yield the rounds. `UserError` where trials leave nothing to go on."""

    @abstractmethod
    def conclude(self, trials: Trials, deliveries: Deliveries, items: Items) -> Any:
        """Return the result. `UserError` where nothing is left to compare."""
