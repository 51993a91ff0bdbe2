"""The audits that are set side by side, how each is called, and what differs between them."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from faultpath.decisions import wording
from faultpath.decisions.family import CORRECT, SHARED
from faultpath.decisions.model import DecisionRecord, Effect
from faultpath.decisions.question import Question
from faultpath.decisions.tables import Line, Table, line
from faultpath.statistics import Sign
from faultpath.trials.provenance import RunProvenance

_DIGITS = 8


@dataclass(frozen=True, eq=False)
class Compared:
    """A finished audit beside others."""

    number: int
    """Its place among them, from 1."""
    folder: str
    record: DecisionRecord
    provenance: RunProvenance
    family: Mapping[str, tuple[Sign, float]] | None = None
    """Of a sweep over sizes: for each path the side that is decided over all of them together, and
    the adjusted p. `None` where every audit stands by itself."""

    @property
    def asked(self) -> Question:
        """What it asked."""
        return self.record.question

    def effect(self, path: str) -> Effect | None:
        """Return its effect on a path, as decided beside the others; `None` where it has none."""
        found = next((each for each in self.record.effects if each.path == path), None)
        if found is None or self.family is None or path not in self.family:
            return found
        sign, p = self.family[path]
        return found.model_copy(update={"sign": sign, "adjusted_p_value": p})

    @property
    def headline(self) -> str:
        """Its own headline, qualified where not all that it decided stands over all sizes."""
        own, family = self.record.verdict.headline, self.family or {}
        fallen = any(e.sign and not family.get(e.path, (e.sign, 0))[0] for e in self.record.effects)
        return f"By itself, and not over all sizes: {own}" if fallen else own

    def absent(self, path: str) -> str:
        """Say why it has no effect on a path."""
        there = any(each.name == path for each in self.record.paths)
        return "every pair void" if there else "no such path"


def titles(runs: Sequence[Compared]) -> dict[str, str]:
    """Return the paths of all runs by name, with titles that say which is primary in all of them.

    Correct inputs stand first and the shared fault last, as in every audit.
    """
    found = {path.name: path.title for run in reversed(runs) for path in run.record.paths}
    order = {path.name: None for run in runs for path in run.record.paths}
    primaries = {run.asked.primary for run in runs}
    return {
        path: f"{found[path]} (primary)" if primaries == {path} else found[path]
        for path in sorted(order, key=lambda path: {CORRECT: 0, SHARED: 2}.get(path, 1))
    }


_ASKED: Mapping[str, Callable[[Compared], str]] = {
    "Fault": lambda run: run.asked.fault,
    "Baseline": lambda run: run.asked.baseline,
    "Repair": lambda run: run.asked.repair,
    "System": lambda run: run.asked.system,
    "Library": lambda run: run.asked.library,
    "State of the library": lambda run: run.asked.library_hash[:_DIGITS],
    "Scenes flown": lambda run: run.record.flown,
    "Scenes compared": lambda run: str(run.record.scenes),
    "Seeds": lambda run: ", ".join(map(str, run.asked.seeds)),
    "Primary path": lambda run: run.asked.primary,
    "Intervals and tests hold for": lambda run: run.record.estimand,
    "Stopping": lambda run: wording.sentence(run.record.stopping or "all scenes were flown"),
}
_MADE: Mapping[str, Callable[[Compared], str]] = {
    "Code, data and packages": lambda run: run.provenance.system_fingerprint[:_DIGITS],
    "faultpath": lambda run: run.provenance.faultpath_version,
    "Python": lambda run: run.provenance.python,
    "Computed with": lambda run: run.provenance.backend or "not said",
    "Processor": lambda run: run.provenance.processor,
    "Platform": lambda run: run.provenance.platform,
}

Facts = Mapping[str, tuple[str, ...]]
"""By title, the value in each run."""


def differing(runs: Sequence[Compared]) -> Facts:
    """Return what differs between runs: what was asked first, then what ran, then on what."""
    packages = [run.provenance.packages for run in runs]
    found = {
        **_asked(runs),
        **{title: tuple(map(read, runs)) for title, read in _MADE.items()},
        **_keyed("Package", packages, "not named"),
    }
    return {title: values for title, values in found.items() if len(set(values)) > 1}


def asked_alike(runs: Sequence[Compared], but_for: Collection[str]) -> bool:
    """Return whether the runs asked the same, but for some facts by their titles."""
    return all(len(set(each)) == 1 or title in but_for for title, each in _asked(runs).items())


def labels(runs: Sequence[Compared]) -> tuple[str, ...]:
    """Return a label for each run: its number, with what of the question tells all of them apart
    if one thing does, and otherwise with its folder."""
    apart = [values for values in _asked(runs).values() if len(set(values)) == len(runs)]
    told = apart[0] if apart else tuple(Path(run.folder).name for run in runs)
    return tuple(f"{run.number}  {text}" for run, text in zip(runs, told, strict=True))


def facts_table(runs: Sequence[Compared], facts: Facts) -> Table:
    """Return what differs, each value with the runs that have it."""

    lines: list[Line] = []
    for title, values in facts.items():
        lines.append(line(title))
        for value in dict.fromkeys(values):
            of = [str(r.number) for r, own in zip(runs, values, strict=True) if own == value]
            lines.append(line(value, wording.series(of)))
    columns = ("Runs",)
    return Table(
        title="What differs", corner="Value", columns=columns, words=columns, lines=tuple(lines)
    )


def _asked(runs: Sequence[Compared]) -> dict[str, tuple[str, ...]]:
    found = {title: tuple(map(read, runs)) for title, read in _ASKED.items()}
    return found | _keyed("Option", [run.asked.options for run in runs], "not given")


def _keyed(
    title: str, each: Sequence[Mapping[str, str]], absent: str
) -> dict[str, tuple[str, ...]]:
    keys = sorted({key for values in each for key in values})
    return {f"{title} {key}": tuple(values.get(key, absent) for values in each) for key in keys}
