"""Which signals of a report are plotted together, and which plot is shown first."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.interface import Provenance
from faultpath.report.inputs import ReportInput
from faultpath.report.sentences import wording
from faultpath.run.store.signals import DRAWN, IN_FORCE, Signal, Signals
from faultpath.run.store.tables import TrialAddress

_MOST_COMPONENTS = 4
"""A rotation matrix says little as lines, unless its numbers have names."""
_PLANT = (Provenance.MEASURED, Provenance.PRIVILEGED)
"""Provenance of what the plant gives, rather than a module."""

_Line: TypeAlias = tuple[str, int]
"""A signal and its component."""
_ByTrial: TypeAlias = dict[TrialAddress, NDArray[Any]]


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

    def described(self) -> dict[str, Any]:
        """Return what the script shows beside the lines."""
        lines, unit = [name for _, name in self.lines], wording.unit(self.unit)
        return {"title": self.title, "unit": unit, "lines": lines, "zero": self.of_errors}


def plots_of(signals: Signals) -> list[Plot]:
    """Return what is plotted of the signals: first errors, then what differs within its topic.

    A plot is one component of one topic: the wind that is reconstructed with the wind that blew.
    Lines that are the same in every trial are one line with two names. A plot in which nothing ever
    changes or differs is left out, unless it is an error, which exists only where a fault made it;
    one that is zero throughout is left out too.
    """
    topics: dict[tuple[str, str, int], dict[_Line, _ByTrial]] = {}
    words: dict[tuple[str, str], tuple[str, ...]] = {}
    for address, named in signals.items():
        for signal in named:
            many_unnamed = signal.values.shape[1] > _MOST_COMPONENTS and not signal.parts
            if signal.name in (IN_FORCE, DRAWN) or many_unnamed:
                continue
            if signal.parts:
                words[signal.topic, signal.unit] = signal.parts
            for part, values in enumerate(signal.values.T):
                lines = topics.setdefault((signal.topic, signal.unit, part), {})
                lines.setdefault((signal.name, part), {})[address] = values
    many = {(topic, unit): part + 1 for topic, unit, part in topics}
    plots: list[Plot] = []
    for (topic, unit, part), lines in topics.items():
        for at in {at for trials in lines.values() for at in trials}:
            values = np.concatenate([trials[at] for trials in lines.values() if at in trials])
            values = values[np.isfinite(values)]
            if values.size and (("error" in topic and values.any()) or np.ptp(values) > 0):
                break
        else:
            continue
        title, units = wording.in_words(topic), unit.split(", ")
        if (count := many[topic, unit]) > 1:
            called = words.get((topic, unit), range(1, count + 1))[part]
            title, unit = f"{title}, {called}", units[part] if len(units) == count else unit
        same: dict[_Line, list[str]] = {}
        for line, trials in lines.items():
            twin = next((other for other in same if _alike(trials, lines[other])), line)
            same.setdefault(twin, []).append(line[0])
        named = tuple((line, ", ".join(names)) for line, names in same.items())
        plots.append(Plot(title, unit, named))
    return sorted(plots, key=lambda plot: (not plot.of_errors, len(plot.lines) < 2))


def first_plot(source: ReportInput, signals: Signals, plots: Sequence[Plot]) -> int:
    """Return the plot that the player opens on: one that shows how the trials went.

    That is the position; else what the plant gives and no module reads, which success is judged by;
    else a measured input that the fault does not change, or one that it does. What stays as it is
    throughout each trial says nothing of how it went.
    """
    plant = {s.name for s in source.system.interface.sources if s.provenance in _PLANT}
    channels = {name: c.name for c in source.system.interface.channels for name in c.sources}
    taps = [
        tap
        for condition in source.record.conditions
        for tap in (*condition.faulted, *condition.baseline_faulted)
    ]
    faulted = {tap.channel for tap in taps}
    moving = {signal.name for named in signals.values() for signal in named if _moves(signal)}

    def rank(place: int) -> int:
        if plots[place].title == "position":
            return 0
        names = {name for (name, _), _ in plots[place].lines}
        shown = {channels.get(name, "") for name in names & plant & moving}
        if not shown:
            return 4
        if "" in shown:
            return 1
        return 3 if shown <= faulted else 2

    return min(range(len(plots)), key=rank, default=0)


def _moves(signal: Signal) -> bool:
    known = signal.values[np.isfinite(signal.values).all(axis=1)]
    return bool(len(known)) and bool((known != known[0]).any())


def _alike(one: _ByTrial, other: _ByTrial) -> bool:
    # What the loop ends with may be missing in one of two signals.
    return one.keys() == other.keys() and all(
        abs(len(a) - len(b)) < 2 and np.array_equal(a[: len(b)], b[: len(a)], equal_nan=True)
        for a, b in ((one[at], other[at]) for at in one)
    )
