"""What differs between runs: question, scenes, code, weights, packages, machine."""

import hashlib
import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from faultpath.code import named
from faultpath.record import wording
from faultpath.record.provenance import RunProvenance
from faultpath.report.comparison.runs import Compared, numbers
from faultpath.tables import Line, Table, line

_DIGITS = 8
_ASKED: tuple[tuple[str, Callable[[Compared], str]], ...] = (
    ("Fault", lambda run: run.asked.fault),
    ("Baseline", lambda run: run.asked.baseline),
    ("Repair", lambda run: run.asked.repair),
    ("System", lambda run: run.asked.system),
    ("Library", lambda run: run.asked.library),
    ("State of the library", lambda run: run.asked.library_hash[:_DIGITS]),
    ("Scenes flown", lambda run: run.record.flown),
    ("Scenes compared", lambda run: str(run.record.scenes)),
    ("Seeds", lambda run: ", ".join(map(str, run.asked.seeds))),
    ("Primary path", lambda run: run.asked.primary),
    ("Intervals and tests speak of", lambda run: run.record.estimand),
    ("Stopping", lambda run: wording.sentence(run.record.stopping or "all scenes were flown")),
)
_MADE: tuple[tuple[str, Callable[[RunProvenance], str]], ...] = (
    ("faultpath", lambda made: made.faultpath_version),
    ("Python", lambda made: made.python),
    ("Computed with", lambda made: made.backend or "not said"),
    ("Processor", lambda made: made.processor),
    ("Platform", lambda made: made.platform),
)


@dataclass(frozen=True)
class Fact:
    """Something that differs, with its value in each run."""

    title: str
    values: tuple[str, ...]


def differing(runs: Sequence[Compared]) -> tuple[Fact, ...]:
    """Return what differs between runs: what was asked first, then what flew, then on what."""
    found = (*_asked(runs), *_flown(runs), *_made(runs))
    return tuple(fact for fact in found if len(set(fact.values)) > 1)


def asked_alike(runs: Sequence[Compared], but_for: Collection[str]) -> bool:
    """Return whether the runs asked the same, but for some facts by their titles."""
    found = (fact for fact in _asked(runs) if len(set(fact.values)) > 1)
    return all(fact.title in but_for for fact in found)


def labels(runs: Sequence[Compared]) -> tuple[str, ...]:
    """Return a label for each run: its number, with what of the question tells all of them apart
    if one thing does, and otherwise with its folder."""
    facts = [fact for fact in _asked(runs) if len(set(fact.values)) == len(runs)]
    told = facts[0].values if facts else tuple(Path(run.folder).name for run in runs)
    return tuple(f"{run.number}  {text}" for run, text in zip(runs, told, strict=True))


def table(runs: Sequence[Compared], facts: Sequence[Fact]) -> Table:
    """Return what differs, each value with the runs that have it."""
    return Table(
        title="What differs",
        corner="Value",
        columns=("Runs",),
        lines=tuple(each for fact in facts for each in _lines(runs, fact)),
        words=("Runs",),
    )


def _lines(runs: Sequence[Compared], fact: Fact) -> Iterator[Line]:
    yield line(fact.title)
    for value in dict.fromkeys(fact.values):
        having = [run for run, own in zip(runs, fact.values, strict=True) if own == value]
        yield line(value, numbers(having))


def _asked(runs: Sequence[Compared]) -> Iterator[Fact]:
    for title, read in _ASKED:
        yield Fact(title, tuple(map(read, runs)))
    yield from _keyed("Option", [run.asked.options for run in runs], "not given")


def _flown(runs: Sequence[Compared]) -> Iterator[Fact]:
    made = [run.provenance for run in runs]
    code = _state("Code that flew", [_recorded(each, "sources") for each in made])
    data = _state("Data files, such as weights", [_recorded(each, "data") for each in made])
    yield from (code, data)
    packages = tuple(_keyed("Package", [each.packages for each in made], "not named"))
    yield from packages
    if not any(len(set(fact.values)) > 1 for fact in (code, data, *packages)):
        yield Fact("Fingerprint", tuple(each.system_fingerprint[:_DIGITS] for each in made))


def _made(runs: Sequence[Compared]) -> Iterator[Fact]:
    for title, read in _MADE:
        yield Fact(title, tuple(read(run.provenance) for run in runs))


def _recorded(made: RunProvenance, name: str) -> Mapping[str, str] | None:
    found: Mapping[str, str] = getattr(made, name)
    return found if name in made.model_fields_set else None


def _keyed(title: str, each: Sequence[Mapping[str, str]], absent: str) -> Iterator[Fact]:
    for key in sorted({key for values in each for key in values}):
        yield Fact(f"{title} {key}", tuple(values.get(key, absent) for values in each))


def _state(title: str, each: Sequence[Mapping[str, str] | None]) -> Fact:
    known = [files for files in each if files is not None]
    names = sorted({name for files in known for name in files})
    changed = [name for name in names if len({files.get(name) for files in known}) > 1]
    return Fact(f"{title}: {named(changed)}" if changed else title, tuple(map(_digest, each)))


def _digest(files: Mapping[str, str] | None) -> str:
    if files is None:
        return "not recorded"
    if not files:
        return "none"
    text = json.dumps(files, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]
