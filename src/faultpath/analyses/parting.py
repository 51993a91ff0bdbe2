"""Two trials of a scene, compared step by step: what differs first, and how each ended.

Trials of a scene are the same to the bit until something acts on one of them that does not act on
the other, so what is compared is equal or not. Signals are stored in single precision, and say what
a source held at a step; where a fault changed a reading, they also say what the reader got.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from faultpath.core.results import Frozen
from faultpath.interface import Channel, Provenance, module_of
from faultpath.run.shown import SystemShown
from faultpath.run.store.signals import DRAWN, Signal
from faultpath.run.store.tables import TrialAddress
from faultpath.system.outcome import Outcome, Status

Kind: TypeAlias = Literal["reading", "command", "state"]
Values: TypeAlias = NDArray[np.floating[Any]]

_PLANT = (Provenance.MEASURED, Provenance.PRIVILEGED)
_POSITION = "position"


class Ended(Frozen):
    """End of one of the two trials."""

    variant: str
    condition: str
    status: Status | None = None
    """`None` for a trial that never ran."""
    time_s: float | None = None
    """`None` where it is not known."""
    error: str = ""

    @property
    def missing(self) -> bool:
        """Whether it cannot be compared with another one."""
        return self.status in (None, Status.FAILED)


class Difference(Frozen, allow_inf_nan=False):
    """The first step at which readings, commands or the state differ, and what does there."""

    step: int
    time_s: float
    name: str
    """Channel of a reading, source of a command or of the state."""
    modules: tuple[str, ...] = ()
    """Modules whose reading it is."""
    delivered: bool = False
    """Whether `values` are what the reader got, and not what its source held."""
    unit: str = ""
    component: int | None = None
    """The component that differs most, counted from 1; `None` for a single number."""
    part: str = ""
    """Its name, where it has one."""
    values: tuple[float, float]
    others: int = Field(0, ge=0)
    """Number of others of its kind that differ at that step."""
    most: tuple[float, tuple[float, float]] | None = None
    """When its values differ most, and both there; `None` where that is at this step."""


class Parting(Frozen):
    """Two trials of a scene, compared step by step."""

    scene: str
    seed: int
    trials: tuple[Ended, Ended]
    compared: tuple[Kind, ...] = ()
    """Kinds that are known of both, so that one without a difference is equal; empty where there is
    nothing to compare."""
    first: dict[Kind, Difference] = Field(default_factory=dict[Kind, Difference])
    """The first difference of each kind that differs at all."""
    alone: tuple[tuple[str, ...], tuple[str, ...]] = ((), ())
    """Modules that read something in one of the two trials, and nothing in the other."""


@dataclass(frozen=True)
class Recorded:
    """A trial with what was recorded of it."""

    address: TrialAddress
    outcome: Outcome | None
    signals: Sequence[Signal] = ()

    @cached_property
    def by_name(self) -> Mapping[str, Signal]:
        """Its signals by their names."""
        return {signal.name: signal for signal in self.signals}


@dataclass(frozen=True)
class _Series:
    """One thing that both trials have: its name and its values in each."""

    name: str
    one: Values
    other: Values
    modules: tuple[str, ...] = ()
    delivered: bool = False
    unit: str = ""
    parts: tuple[str, ...] = ()

    def common(self) -> tuple[Values, Values]:
        """Return the values of both at the steps that both have."""
        steps = min(len(self.one), len(self.other))
        return self.one[:steps].astype(np.float64), self.other[:steps].astype(np.float64)

    def differs(self) -> tuple[int, int] | None:
        """Return the first step at which both are known and differ, and the component that does
        so most; `None` where they are equal."""
        with np.errstate(invalid="ignore"):
            apart = np.abs(np.subtract(*self.common()))
        apart = np.nan_to_num(apart, nan=0.0, posinf=0.0)
        differing = np.flatnonzero(apart.any(axis=1))
        return (int(differing[0]), int(apart[differing[0]].argmax())) if differing.size else None


def parting(system: SystemShown, one: Recorded, other: Recorded) -> Parting:
    """Compare two trials of a scene: both variants, or one variant under two conditions."""
    at = one.address
    ends = _ended(one), _ended(other)
    if any(end.missing for end in ends):
        return Parting(scene=at.scene, seed=at.seed, trials=ends)
    series: dict[Kind, list[_Series]] = {
        "reading": list(_readings(system, one, other)),
        "command": list(_sources(system, one, other, (Provenance.COMMANDED,))),
        "state": list(_state(system, one, other)),
    }
    first: dict[Kind, Difference] = {}
    for kind, compared in series.items():
        if difference := _first(compared, system.control_dt_s):
            first[kind] = difference
    readers = {variant.name: variant.readers for variant in system.variants}
    mine, theirs = (
        {module_of(reader) for reader in readers.get(trial.address.variant, ())}
        for trial in (one, other)
    )
    return Parting(
        scene=at.scene,
        seed=at.seed,
        trials=ends,
        compared=tuple(kind for kind, compared in series.items() if compared),
        first=first,
        alone=(tuple(sorted(mine - theirs)), tuple(sorted(theirs - mine))),
    )


def _ended(trial: Recorded) -> Ended:
    variant, condition = trial.address.variant, trial.address.condition
    if (outcome := trial.outcome) is None:
        return Ended(variant=variant, condition=condition)
    return Ended(
        variant=variant,
        condition=condition,
        status=outcome.status,
        time_s=None if np.isnan(outcome.time_s) else outcome.time_s,
        error=outcome.error or "",
    )


def _first(series: Iterable[_Series], dt_s: float) -> Difference | None:
    """Return the first difference; of several at one step that of the first series."""
    differing = [(at, values) for values in series if (at := values.differs())]
    if not differing:
        return None
    (step, component), first = min(differing, key=lambda pair: pair[0][0])
    values = float(first.one[step, component]), float(first.other[step, component])
    with np.errstate(invalid="ignore"):
        apart = np.abs(np.subtract(*(values[:, component] for values in first.common())))
    last = int(np.nan_to_num(apart, nan=0.0, posinf=0.0).argmax())
    most = float(first.one[last, component]), float(first.other[last, component])
    many = first.one.shape[1] > 1
    units = first.unit.split(", ")
    if len(units) != first.one.shape[1]:  # one unit for all, or it is not known which is whose
        units = [first.unit if len(units) == 1 else ""] * first.one.shape[1]
    return Difference(
        step=step,
        time_s=round(step * dt_s, 9),
        name=first.name,
        modules=first.modules,
        delivered=first.delivered,
        unit=units[component],
        component=component + 1 if many else None,
        part=first.parts[component] if first.parts and many else "",
        values=values,
        others=sum(at[0] == step for at, _ in differing) - 1,
        most=None if last == step else (round(last * dt_s, 9), most),
    )


def _readings(system: SystemShown, one: Recorded, other: Recorded) -> Iterator[_Series]:
    """Yield what modules of both trials read, first what a fault changed, then by source.

    A command that modules read is left to the commands, unless a fault changed it.
    """
    variants = {variant.name: variant for variant in system.variants}
    trials = one, other
    both = [variants[name] for trial in trials if (name := trial.address.variant) in variants]
    if len(both) < 2:
        return
    read = set(both[0].readers) & set(both[1].readers)
    commanded = {s.name for s in system.interface.sources if s.provenance is Provenance.COMMANDED}
    unchanged: list[_Series] = []
    for channel in system.interface.channels:
        readers = [reader for reader in channel.readers if reader in read]
        modules = tuple(dict.fromkeys(map(module_of, readers)))
        old, new = (variant.bindings.get(channel.name, channel.sources[0]) for variant in both)
        source = list(_pair(channel.name, trials, (old, new), modules))
        apart = source[0].differs() if source else None
        for reader in readers:
            yield from _delivered(channel, reader, trials, apart[0] if apart else None)
        if modules and not commanded & {old, new}:
            unchanged += source
    yield from unchanged


def _delivered(
    channel: Channel, reader: str, trials: Sequence[Recorded], until: int | None
) -> Iterator[_Series]:
    """Yield what one reader got where a fault changed it in a trial; where in one alone, the other
    got what this one would have got without the fault, `until` their sources differ."""
    got = [trial.by_name.get(f"{channel.name} at {reader}") for trial in trials]
    wrong = [trial.by_name.get(f"{channel.name} error at {reader}") for trial in trials]
    values = [None if signal is None else signal.values for signal in got]
    for place, (mine, error) in enumerate(zip(got, wrong, strict=True)):
        if mine and error and values[1 - place] is None:
            values = [None if part is None else part[:until] for part in values]
            values[1 - place] = (mine.values - error.values)[:until]
            break
    one, other = values
    known = got[0] or got[1]
    if known and one is not None and other is not None and one.shape[1] == other.shape[1]:
        modules = (module_of(reader),)
        yield _Series(channel.name, one, other, modules, True, known.unit, known.parts)


def _pair(
    name: str,
    trials: Sequence[Recorded],
    sources: tuple[str, str],
    modules: tuple[str, ...] = (),
) -> Iterator[_Series]:
    """Yield two sources that both were recorded, as one series."""
    one, other = (trial.by_name.get(at) for trial, at in zip(trials, sources, strict=True))
    if one and other and one.values.shape[1] == other.values.shape[1]:
        yield _Series(name, one.values, other.values, modules, False, one.unit, one.parts)


def _sources(
    system: SystemShown, one: Recorded, other: Recorded, provenances: Sequence[Provenance]
) -> Iterator[_Series]:
    for source in system.interface.sources:
        if source.provenance in provenances:
            yield from _pair(source.name, (one, other), (source.name, source.name))


def _state(system: SystemShown, one: Recorded, other: Recorded) -> Iterator[_Series]:
    """Yield what the plant gives: positions, its picture, its truths, and what it measures."""
    traces = [trial.outcome.trace if trial.outcome else None for trial in (one, other)]
    if traces[0] is not None and traces[1] is not None:
        yield _Series(_POSITION, traces[0], traces[1], unit="m")
    yield from _sources(system, one, other, _PLANT)
    sources = {source.name for source in system.interface.sources}
    for signal in one.signals:
        part, _, truth = signal.name.partition(".")
        if truth and " " not in signal.name and part not in sources:
            yield from _pair(signal.name, (one, other), (signal.name, signal.name))
    yield from _pair(DRAWN, (one, other), (DRAWN, DRAWN))
