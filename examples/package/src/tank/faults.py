"""A kind of fault: the sensor that shows no more than it can."""

from typing import Literal

from faultpath.faults import Intervention, Moment


class Saturate(Intervention):
    """Show at most a largest value."""

    kind: Literal["saturate"] = "saturate"
    phrase = "at most {most}"
    most: float

    def apply(self, reading, memory, at: Moment):
        return reading.clip(max=self.most), None  # NumPy's arrays and torch's tensors have it
