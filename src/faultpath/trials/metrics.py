"""What a trial leaves behind beside its status and its time, by name."""

from typing import Annotated, Literal

from pydantic import StringConstraints

from faultpath.core.frozen import Frozen
from faultpath.interface.model import Words

MetricName = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]*$")]


class Metric(Frozen):
    """A number that every trial of a system has, such as a return or an RMS error."""

    unit: Words
    """`1` for a number without a unit."""
    better: Literal["less", "more"]
    words: Words = ""
    """What it is called within a sentence; empty for its name without the unit."""
    title: Words = ""
    """What it is called above a picture; empty for its words."""

    def said(self, name: str) -> str:
        """Return its words, given its name."""
        return self.words or name.removesuffix(f"_{self.unit}").replace("_", " ")


VEHICLE = {
    "terminal_distance_m": Metric(
        unit="m",
        better="less",
        words="terminal distance",
        title="Distance to the goal at the end",
    ),
    "min_clearance_m": Metric(unit="m", better="more", words="least clearance"),
}
"""Metrics of a vehicle that flies to a goal among obstacles. Tables hold both or neither."""
