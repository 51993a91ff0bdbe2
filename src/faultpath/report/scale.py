"""Linear axes with round tick marks, and what every picture draws along them."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from faultpath.report.svg import Svg


@dataclass(frozen=True)
class Axis:
    """Maps data from `low..high` to pixels from `start` to `end`."""

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        """Return the pixel of a value."""
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self, about: int = 5) -> list[float]:
        """Return round numbers inside the axis, roughly `about` of them."""
        step = _round_step((self.high - self.low) / max(about, 1))
        first = math.ceil(self.low / step - 1e-9)
        last = math.floor(self.high / step + 1e-9)
        return [i * step for i in range(first, last + 1)]

    def at(self, start: float, end: float) -> "Axis":
        """Return the same data range over other pixels."""
        return Axis(self.low, self.high, start, end)


def covering(values: Iterable[float], margin: float = 0.06, least: float = 1.0) -> Axis:
    """Return an axis from 0 to 1 pixel that covers 0 and every value, with a margin."""
    inside = [0.0, *values]
    low, high = min(inside), max(inside)
    if high - low < least:
        middle = 0.5 * (low + high)
        low, high = middle - 0.5 * least, middle + 0.5 * least
    pad = margin * (high - low)
    return Axis(low - pad, high + pad, 0.0, 1.0)


def tick_label(value: float) -> str:
    """Return a short label with a real minus sign."""
    return f"{value:g}".replace("-", "−")


def draw_levels(svg: Svg, x: Axis, y: Axis, about: int, zero: str = "axis") -> None:
    """Draw the round levels of an upward axis across the plot, labels to their left."""
    for tick in y.ticks(about):
        svg.line((x.start, y(tick)), (x.end, y(tick)), zero if tick == 0 else "axis")
        svg.text(x.start - 6, y(tick) + 4, tick_label(tick), "small soft", "end")


def draw_tick(svg: Svg, x: Axis, y: Axis, value: float, label: str) -> None:
    """Draw a tick of the lower axis with its label below."""
    svg.line((x(value), y.start), (x(value), y.start + 4), "axis")
    svg.text(x(value), y.start + 17, label, "small soft", "middle")


def draw_uprights(svg: Svg, x: Axis, top: float, bottom: float, about: int) -> None:
    """Draw the round numbers of an axis from top to bottom, labels below."""
    for tick in x.ticks(about):
        svg.line((x(tick), top), (x(tick), bottom), "zero" if tick == 0 else "axis")
        svg.text(x(tick), bottom + 16, tick_label(tick), "small soft", "middle")


def draw_interval(
    svg: Svg, x: Callable[[float], float], ends: Sequence[float], y: float, half: float, cls: str
) -> None:
    """Draw an interval with whiskers that reach `half` to either side."""
    low, high = ends
    svg.line((x(low), y), (x(high), y), cls)
    for end in ends:
        svg.line((x(end), y - half), (x(end), y + half), cls)


def _round_step(raw: float) -> float:
    power = 10.0 ** math.floor(math.log10(raw))
    return power * next(m for m in (1.0, 2.0, 5.0, 10.0) if raw <= m * power * 1.0001)
