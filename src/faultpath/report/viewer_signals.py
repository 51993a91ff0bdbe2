"""Which signals the flight viewer plots, and with what beside them.

A plot is one component of one topic: the wind that is reconstructed with the wind that blew. Lines
that are the same in every trial are one line with two names. A plot in which nothing ever changes
or differs is left out, unless it is an error, which exists only where a fault made it; one that is
zero throughout is left out too.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.decisions import wording
from faultpath.trials.store import TrialAddress
from faultpath.trials.store.signals import IN_FORCE, Signal, Signals

_MOST_COMPONENTS = 4
"""A rotation matrix or an image says little as lines."""
_LEVELS = 4095
_GAP = -1
"""In place of a level, where nothing was read."""

_Line: TypeAlias = tuple[str, int]
"""A signal and its component."""
_Trials: TypeAlias = Mapping[TrialAddress, NDArray[Any]]
_Lines: TypeAlias = dict[_Line, dict[TrialAddress, NDArray[Any]]]


@dataclass(frozen=True)
class Plot:
    """Lines of one unit on one pair of axes."""

    title: str
    unit: str
    lines: tuple[tuple[_Line, str], ...]
    """Each with what it is called."""

    @property
    def of_errors(self) -> bool:
        """Whether it is held against zero."""
        return "error" in self.title

    @property
    def shown(self) -> dict[str, Any]:
        """What a page shows of it."""
        lines = [name for _, name in self.lines]
        unit = wording.unit(self.unit)
        return {"title": self.title, "unit": unit, "lines": lines, "zero": self.of_errors}


def plots(signals: Signals) -> tuple[Plot, ...]:
    """Return what is plotted of the signals: first errors, then what differs within its topic."""
    topics: dict[tuple[str, str, int], _Lines] = {}
    for address, named in signals.items():
        for each in named:
            if each.name == IN_FORCE or each.values.shape[1] > _MOST_COMPONENTS:
                continue
            for part, values in enumerate(each.values.T):
                lines = topics.setdefault((each.topic, each.unit, part), {})
                lines.setdefault((each.name, part), {})[address] = values
    many = {(topic, unit): part + 1 for topic, unit, part in topics}
    made: list[Plot] = []
    for (topic, unit, part), lines in topics.items():
        if not _worth_it(topic, lines):
            continue
        title, units = topic.replace("_", " "), unit.split(", ")
        if (count := many[topic, unit]) > 1:
            title, unit = f"{title}, {part + 1}", units[part] if len(units) == count else unit
        same: dict[_Line, list[str]] = {}
        for line, trials in lines.items():
            twin = next((other for other in same if _alike(trials, lines[other])), line)
            same.setdefault(twin, []).append(line[0])
        made.append(Plot(title, unit, tuple((ln, ", ".join(names)) for ln, names in same.items())))
    return tuple(sorted(made, key=lambda plot: (not plot.of_errors, len(plot.lines) < 2)))


def _worth_it(topic: str, lines: _Lines) -> bool:
    """Return whether anything changes in a trial, or an error is not zero throughout."""
    for at in {at for trials in lines.values() for at in trials}:
        values = np.concatenate([trials[at] for trials in lines.values() if at in trials])
        values = values[np.isfinite(values)]
        if values.size and (("error" in topic and values.any()) or values.min() < values.max()):
            return True
    return False


def _alike(one: _Trials, other: _Trials) -> bool:
    # What the loop ends with may be missing in one of two signals.
    return one.keys() == other.keys() and all(
        abs(len(a) - len(b)) < 2 and np.array_equal(a[: len(b)], b[: len(a)], equal_nan=True)
        for a, b in ((one[at], other[at]) for at in one)
    )


def drawn(
    named: Mapping[str, Signal], shown: Iterable[Plot], series: list[NDArray[np.int32]]
) -> list[list[float | int]]:
    """Return a trial's lines as `[plot, line, place in series, lowest value, value of a level]`."""
    found: list[list[float | int]] = []
    for number, plot in enumerate(shown):
        for place, ((name, part), _) in enumerate(plot.lines):
            if name not in named:
                continue
            values = named[name].values[:, part].astype(np.float64)
            finite = values[np.isfinite(values)]
            if not finite.size:
                continue
            low = float(finite.min())
            level = float(finite.max() - low) / _LEVELS or 1.0
            whole = np.where(np.isfinite(values), np.rint((values - low) / level), _GAP)
            found.append([number, place, len(series), float(f"{low:.7g}"), float(f"{level:.7g}")])
            series.append(whole.astype(np.int32))
    return found


def in_force(named: Mapping[str, Signal]) -> list[list[int]]:
    """Return the spans of control steps, first and one past the last, with a fault in force."""
    if IN_FORCE not in named:
        return []
    edges = np.flatnonzero(np.diff(named[IN_FORCE].values[:, 0] > 0, prepend=False, append=False))
    return edges.reshape(-1, 2).tolist()
