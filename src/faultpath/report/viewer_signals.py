"""Which signals the flight viewer plots, and with what beside them.

A plot is one component of one topic: the wind that is reconstructed with the wind that blew. Lines
that are the same in every trial are one line with two names. A plot in which nothing ever changes
or differs is left out, unless it is an error, which exists only where a fault made it; one that is
zero throughout is left out too.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.record import wording
from faultpath.report.viewer_packing import Whole
from faultpath.store import TrialAddress
from faultpath.store.signals import IN_FORCE, Signal, Signals

_MOST_COMPONENTS = 4
"""A rotation matrix or an image says little as lines, where nobody named its components."""
_LEVELS = 4095
_GAP = -1
"""In place of a level, where nothing was read."""

_Line: TypeAlias = tuple[str, int]
"""A signal and its component."""


@dataclass(frozen=True)
class Plot:
    """Lines of one unit on one pair of axes."""

    title: str
    unit: str
    lines: tuple[tuple[_Line, str], ...]
    """Each with what it is called."""

    @property
    def told(self) -> dict[str, Any]:
        """What a page says of it."""
        lines = [name for _, name in self.lines]
        unit = wording.unit(self.unit)
        return {"title": self.title, "unit": unit, "lines": lines, "zero": self.of_errors}

    @property
    def of_errors(self) -> bool:
        """Whether it is held against zero."""
        return "error" in self.title


def plots(signals: Signals) -> tuple[Plot, ...]:
    """Return what is plotted of the signals: first errors, then what differs within its topic."""
    topics: dict[tuple[str, str, int], dict[_Line, dict[TrialAddress, NDArray[Any]]]] = {}
    parts: dict[tuple[str, str], tuple[str, ...]] = {}
    for address, named in signals.items():
        for each in named:
            if each.name == IN_FORCE:
                continue
            if each.values.shape[1] > _MOST_COMPONENTS and not each.parts:
                continue
            parts[each.topic, each.unit] = each.parts or parts.get((each.topic, each.unit), ())
            for part, values in enumerate(each.values.T):
                lines = topics.setdefault((each.topic, each.unit, part), {})
                lines.setdefault((each.name, part), {})[address] = values
    many = {(topic, unit): part + 1 for topic, unit, part in topics}
    made = [
        Plot(*_called(topic, unit, part, many[topic, unit], parts[topic, unit]), _told(lines))
        for (topic, unit, part), lines in topics.items()
        if ("error" in topic and _differs(lines.values())) or _varies(lines.values())
    ]
    return tuple(sorted(made, key=lambda plot: (not plot.of_errors, len(plot.lines) < 2)))


def drawn(
    named: Mapping[str, Signal], shown: Iterable[Plot], series: list[Whole]
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


def _called(topic: str, unit: str, part: int, many: int, names: Sequence[str]) -> tuple[str, str]:
    topic = topic.replace("_", " ")
    if many == 1:
        return topic, unit
    units = unit.split(", ")
    name = names[part] if len(names) == many else part + 1
    return f"{topic}, {name}", units[part] if len(units) == many else unit


def _varies(lines: Iterable[Mapping[TrialAddress, NDArray[Any]]]) -> bool:
    trials: dict[TrialAddress, list[NDArray[Any]]] = {}
    for line in lines:
        for at, values in line.items():
            trials.setdefault(at, []).append(values[np.isfinite(values)])
    joined = (np.concatenate(parts) for parts in trials.values())
    return any(values.size and values.min() < values.max() for values in joined)


def _differs(lines: Iterable[Mapping[TrialAddress, NDArray[Any]]]) -> bool:
    return any(np.nan_to_num(values).any() for line in lines for values in line.values())


def _told(
    lines: Mapping[_Line, Mapping[TrialAddress, NDArray[Any]]],
) -> tuple[tuple[_Line, str], ...]:
    kept: list[tuple[_Line, list[str]]] = []
    for line, trials in lines.items():
        for other, names in kept:
            if _alike(trials, lines[other]):
                names.append(line[0])
                break
        else:
            kept.append((line, [line[0]]))
    return tuple((line, _names(names)) for line, names in kept)


def _alike(
    one: Mapping[TrialAddress, NDArray[Any]], other: Mapping[TrialAddress, NDArray[Any]]
) -> bool:
    return one.keys() == other.keys() and all(
        np.array_equal(*_cut(one[at], other[at]), equal_nan=True) for at in one
    )


def _cut(one: NDArray[Any], other: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    steps = min(len(one), len(other))
    return (one[:steps], other[:steps]) if abs(len(one) - len(other)) < 2 else (one, other)


def _names(names: list[str]) -> str:
    more = len(names) - 2
    return ", ".join(names[:2]) + (f" and {more} more" if more > 0 else "")
