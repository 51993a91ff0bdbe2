"""How the errors of two modules add up in one scene, from recorded signals: which, and in words."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faultpath.record import CORRECT, wording
from faultpath.record.words import where
from faultpath.report.inputs import ReportInput
from faultpath.report.pairing import Pair
from faultpath.report.viewer_choice import choose
from faultpath.store import TrialAddress
from faultpath.store.signals import TOGETHER, Signal
from faultpath.trials import Status

_SQUEEZED = 2.5
_MOST_PATHS = 4
"""The last ones, among them the shared fault."""


@dataclass(frozen=True)
class Lines:
    """Two errors of one trial and their sum."""

    role: str
    name: str
    values: NDArray[np.float64]
    """`[3, T]`: the errors and their sum, a number a control step, not a number where unknown."""
    status: Status
    ended: str
    time_s: float

    @property
    def sizes(self) -> tuple[float, ...]:
        """Mean size of each, while the trial ran."""
        return tuple(float(each) for each in np.nanmean(np.abs(self.values), axis=1))


@dataclass(frozen=True)
class Adding:
    """One scene: on every path of the fault the errors of both arms."""

    scene: str
    words: str
    """What they are errors of."""
    unit: str
    names: tuple[str, ...]
    """Of the two errors and of their sum."""
    dt_s: float
    paths: tuple[tuple[str, str, tuple[Lines, ...]], ...]
    """Name and title of a path, with the baseline's lines and the repair's."""

    @property
    def span(self) -> tuple[float, float]:
        """The range of the values; where a few would squeeze the others, that of the others."""
        values = self._every
        low, high = (float(end) for end in np.quantile(values, (0.03, 0.97)))
        few = values.max() - values.min() > _SQUEEZED * max(high - low, 1e-9)
        return (low, high) if few else (float(values.min()), float(values.max()))

    @property
    def cut(self) -> bool:
        """Whether some values lie outside that range."""
        low, high = self.span
        return bool(self._every.min() < low or self._every.max() > high)

    @property
    def _every(self) -> NDArray[np.float64]:
        arms = (arm.values for _, _, both in self.paths for arm in both)
        return np.concatenate([values[np.isfinite(values)] for values in arms])

    @property
    def caption(self) -> str:
        """Say what is to be seen on the last path, in numbers of this scene alone."""
        path, _, arms = self.paths[-1]
        digits = 2 if min(max(arm.sizes) for arm in arms) < 1 else 1
        told = "; ".join(self._said(arm, digits) for arm in arms)
        return f"In scene {self.scene}, {where(path)}, {told}."

    def _said(self, arm: Lines, digits: int) -> str:
        one, other, both = (f"{wording.plain(size, digits)} {self.unit}" for size in arm.sizes)
        return (
            f"the errors of {arm.name} are {one.removesuffix(f' {self.unit}')} and {other} on "
            f"average and their sum {both} ({arm.ended} after {arm.time_s:.1f} s)"
        )


def adding(source: ReportInput, pairs: Sequence[Pair]) -> Adding | None:
    """Return the first scene of the viewer of which both errors are known on a path of the fault.

    `None` where the system names no errors, or nothing was recorded.
    """
    for showing in choose(source.record, source.traces, pairs) if source.signals else ():
        found = _of(source, showing.pairs)
        if found is not None:
            return found
    return None


def _of(source: ReportInput, pairs: Mapping[str, Pair]) -> Adding | None:
    asked = source.record.question
    arms = (("baseline", asked.baseline), ("repair", asked.repair))
    paths: list[tuple[str, str, tuple[Lines, ...]]] = []
    terms: list[Signal] = []
    for path in source.record.paths:
        if path.name == CORRECT or path.name not in pairs:
            continue
        lines: list[Lines] = []
        for role, name in arms:
            pair = pairs[path.name]
            trial = pair.baseline if role == "baseline" else pair.repair
            at = TrialAddress(name, path.name, pair.seed, pair.scene)
            found = _terms(source.signals.get(at, ()))
            if trial is not None and found:
                terms = [*found]
                values = np.array([each.values[:, 0] for each in found], np.float64)
                ended = wording.ended(asked, trial.status)
                lines.append(Lines(role, name, values, trial.status, ended, trial.time_s))
        if len(lines) == len(arms):
            paths.append((path.name, path.title, tuple(lines)))
    if not paths:
        return None
    names = tuple(each.name for each in terms)
    return Adding(
        next(iter(pairs.values())).scene,
        terms[0].topic,
        wording.unit(terms[0].unit),
        names,
        source.traces.dt_s,
        tuple(paths[-_MOST_PATHS:]),
    )


def _terms(named: Sequence[Signal]) -> tuple[Signal, ...]:
    topics = [each.topic for each in named if each.name == TOGETHER]
    found = [each for each in named if each.topic in topics]
    known = all(np.isfinite(each.values).any() for each in found)
    return (*found,) if len(found) == 3 and found[-1].name == TOGETHER and known else ()
