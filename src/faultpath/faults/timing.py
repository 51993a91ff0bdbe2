"""Interventions on when a reading arrives: late, seldom, not any more, not always.

Each keeps copies, so a producer may reuse the memory of its readings.
"""

from typing import ClassVar, Literal, Self

from pydantic import Field

from faultpath.core.arrays import Array, copy, pick, place
from faultpath.faults.base import Intervention, Memory, Moment, number
from faultpath.faults.values import Erase
from faultpath.interface import Channel


class Delay(Intervention):
    """Deliver the reading of some steps ago; the first reading until there is one that old."""

    kind: Literal["delay"] = "delay"
    said = "delayed by {steps} steps"
    value_field: ClassVar[str | None] = "steps"
    steps: int = Field(ge=0)

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return an empty past."""
        return ()

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the newest reading that is at least `steps` old, and the past since it."""
        past = (*memory, (at.step, copy(reading)))
        while len(past) > 1 and past[1][0] <= at.step - self.steps:
            past = past[1:]
        return past[0][1], past


class Hold(Intervention):
    """Refresh the reading at every n-th step from the onset on: a lower rate."""

    kind: Literal["hold"] = "hold"
    said = "refreshed every {every} steps"
    value_field: ClassVar[str | None] = "every"
    every: int = Field(ge=1)
    """Steps between two refreshes."""

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the held reading and which refresh it belongs to."""
        return copy(reading), at.elapsed // self.every

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the held reading, refreshed when its time has come."""
        held, turn = memory
        now = at.elapsed // self.every
        if now != turn or at.elapsed < 0:
            held = copy(reading)
        return held, (held, now)


class Freeze(Intervention):
    """Hold the reading of the onset (paper: freezing).

    Where a tap is silent at the onset, its last reading before that; if it has none, its first.
    """

    kind: Literal["freeze"] = "freeze"
    said = "frozen"

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the reading to hold."""
        return copy(reading)

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the held reading, which follows the readings up to the onset."""
        held = copy(reading) if at.elapsed <= 0 else memory
        return held, held


class Dropout(Intervention):
    """Lose each reading with a probability, drawn per scene and step."""

    kind: Literal["dropout"] = "dropout"
    value_field: ClassVar[str | None] = "probability"
    random: ClassVar[bool] = True
    probability: float = Field(ge=0, le=1)
    substitute: Erase | None = None
    """Delivered instead of a lost reading; `None`: the last that arrived, or else the first."""

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the last reading that arrived."""
        return copy(reading)

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the reading where it arrives and the substitute where it is lost."""
        if at.elapsed < 0 or not self.probability:
            return reading, copy(reading)
        arrives = place(at.draws.uniform((), at.step) >= self.probability, reading)
        last = pick(arrives, reading, memory)
        if self.substitute is None:
            return last, last
        erased, _ = self.substitute.apply(reading, None, at)
        return pick(arrives, reading, erased), last

    def words(self) -> str:
        """Return `lost with probability PROBABILITY`, and what is delivered then."""
        instead = "held" if self.substitute is None else self.substitute.words()
        return f"lost with probability {number(self.probability)}, then {instead}"

    def resolved(self, channel: Channel) -> Self:
        """Take the channel's erasure default where the substitute names none."""
        if self.substitute is None:
            return self
        return self.model_copy(update={"substitute": self.substitute.resolved(channel)})

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Refuse a substitute that the reading does not fit."""
        return None if self.substitute is None else self.substitute.misfit(shape)
