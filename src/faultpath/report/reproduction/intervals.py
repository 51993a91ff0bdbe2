"""Estimates with their intervals, small enough to stand in a line of text."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import log10

from faultpath.report.svg import Axis, Svg, covering, draw_interval, tick_label

WIDTH = 150.0
_HEIGHT, _LABELLED = 24.0, 35.0
_ROUND = [step * 10.0**power for power in range(-3, 4) for step in (1, 2, 5)]
RATIO = "times"
"""The unit whose scale is logarithmic: half as much lies as far from 1 as twice as much."""


@dataclass(frozen=True)
class Scale:
    """Where the values of one unit stand in every plot of it."""

    axis: Axis
    ratio: bool = False

    @classmethod
    def of(cls, unit: str, values: Iterable[float]) -> "Scale":
        """Return the scale that covers values of a unit, and what means no effect."""
        ratio, found = unit == RATIO, list(values)
        if ratio:
            found = [log10(value) for value in found if value > 0]
        span = max(map(abs, found), default=0.0)
        covered = covering(found, margin=0.04, least=1e-3 * span or 1.0)
        return cls(covered.at(5, WIDTH - 5), ratio)

    @property
    def no_effect(self) -> float:
        """What says that nothing differs: 1 of a ratio, 0 of all else."""
        return 1.0 if self.ratio else 0.0

    def __call__(self, value: float) -> float:
        """Return the pixel of a value."""
        if not self.ratio:
            return self.axis(value)
        return self.axis(log10(value)) if value > 0 else self.axis.start

    def ticks(self) -> list[float]:
        """Return what means no effect and the outermost round numbers that stand free of it."""
        low, high = self.axis.low, self.axis.high
        ticks = [round(tick, 12) for tick in self.axis.ticks(5)]
        if self.ratio:
            ticks = [tick for tick in _ROUND if low <= log10(tick) <= high]
        outer = [t for t in (ticks[0], ticks[-1]) if abs(self(t) - self(self.no_effect)) > 22]
        return sorted({self.no_effect, *outer})

    def labels(self, unit: str) -> list[tuple[float, str]]:
        """Return the ticks with their labels, `unit` behind the one that means no effect."""
        return [
            (tick, tick_label(tick) + (unit if tick == self.no_effect else ""))
            for tick in self.ticks()
        ]


@dataclass(frozen=True)
class Shown:
    """What a plot shows."""

    value: float
    interval: Sequence[float]
    least: float | None = None
    """Least effect that could have been detected."""
    papers: Sequence[float] = ()
    """The paper's figure, and the ends of its interval where it has one."""
    limits: Sequence[float] = ()
    """What the statement is decided at."""
    other: Sequence[float] = ()
    """What another platform gave: estimate and ends of its interval."""

    @property
    def ends(self) -> tuple[float, ...]:
        """Return everything that an axis has to cover."""
        return (self.value, *self.interval, *self.papers, *self.limits, *self.other)


def scale_plot(scale: Scale, title: str, unit: str) -> str:
    """Return the labelled scale that stands over plots that share an axis."""
    svg = Svg(WIDTH, 16, title)
    for tick, label in scale.labels(unit):
        svg.text(scale(tick), 11, label, "tiny", "middle")
        svg.line((scale(tick), 13), (scale(tick), 16), "zero")
    return svg.render()


def interval_plot(title: str, shown: Shown, scale: Scale, unit: str | None = None) -> str:
    """Return one interval: filled where it leaves out what means no effect, open elsewhere.

    The paper's figure is marked above, the thin line below is that of another platform, dashed
    lines are limits that the statement is decided at, where they are not no effect itself. The
    light band beside an open one reaches as far as effects that would probably not have been
    detected; where a `unit` is given, the scale stands below with it.
    """
    low, high = shown.interval
    zero, y = scale.no_effect, 10.0
    open_ = low <= zero <= high
    svg = Svg(WIDTH, _HEIGHT if unit is None else _LABELLED, title)
    if open_ and shown.least and not scale.ratio:
        left, right = max(scale(-shown.least), 0.0), min(scale(shown.least), WIDTH)
        svg.rect(left, y - 8, right - left, 16, "band", 2)
    svg.line((0, y), (WIDTH, y), "axis")
    svg.line((scale(zero), 0), (scale(zero), _HEIGHT), "zero")
    for limit in shown.limits:
        if limit != zero:
            svg.line((scale(limit), 0), (scale(limit), _HEIGHT), "limit")
    draw_interval(svg, scale, shown.interval, y, 3.5, "range")
    svg.circle((scale(shown.value), y), 3.8, "dot open" if open_ else "dot")
    if shown.papers:
        at, *theirs = map(scale, shown.papers)
        if theirs:
            svg.line((theirs[0], 2), (theirs[1], 2), "papers")
        svg.polygon([(at - 3, 0), (at + 3, 0), (at, 5)], "papers-figure")
    if shown.other:
        at, left, right = map(scale, shown.other)
        svg.line((left, y + 10), (right, y + 10), "other")
        svg.circle((at, y + 10), 2.2, "other-dot")
    if unit is not None:
        for tick, label in scale.labels(unit):
            svg.text(scale(tick), _LABELLED - 2, label, "tiny", "middle")
    return svg.render()
