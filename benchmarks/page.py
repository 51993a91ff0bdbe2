"""`docs/performance.md` from `results.json`: its words are here, its numbers only there."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from benchmarks import pictures
from benchmarks.results import ROOT, Machine, Record, Results, Target
from benchmarks.words import HEAD, SECTIONS, number
from faultpath.tables import MISSING, Entry, Line, Table, line
from faultpath.tables.markdown import grid

PAGE = ROOT / "docs" / "performance.md"
RATIOS = ROOT / "docs" / "images" / "performance.svg"
SCALING = ROOT / "docs" / "images" / "performance-scaling.svg"

_COLUMNS = ("faultpath", "compared with", "ratio", "target", "met")
BUSY = 0.5
"""Load above which the page warns."""


def files(results: Results) -> Mapping[Path, str]:
    """Return every file that the results decide, by its path."""
    order = [name for section in SECTIONS for name in section.comparisons]
    records = sorted(results.records, key=lambda record: order.index(record.comparison))
    return {
        PAGE: text(results),
        RATIOS: pictures.ratios(records) + "\n",
        SCALING: pictures.scaling(results.curves) + "\n",
    }


def text(results: Results) -> str:
    """Return the page."""
    parts = [HEAD, *_machine(results.machine), *_summary(results.records)]
    for section in SECTIONS:
        records = [r for r in results.records if r.comparison in section.comparisons]
        parts += [f"## {section.title}", section.words, _table(records)]
        parts += _notes(records)
        for name in section.comparisons:
            if name in results.apart:
                parts += _machine(results.apart[name])
        if section.picture:
            parts.append(section.picture)
    return "\n\n".join(parts) + "\n"


def told(record: Record) -> str:
    """Return a record in one line, for the terminal."""
    ratio = "" if record.ratio is None else f", ratio {_ratio(record)}"
    against = "" if record.peer is None else f" against {number(record.peer)} ({record.peer_name})"
    if record.ours is None:
        return f"{record.name}: {record.note}"
    met = {True: ", met", False: ", MISSED", None: ""}[record.met]
    return f"{record.name}: {number(record.ours)} {record.unit}{against}{ratio}{met}"


def _machine(machine: Machine) -> Iterator[str]:
    packages = ", ".join(f"{name} {version}" for name, version in machine.packages.items())
    changed = ", with uncommitted changes" if machine.dirty else ""
    commit = f"commit `{machine.commit[:12]}`{changed}" if machine.commit else "no commit known"
    yield (
        f"Measured on {machine.date}: {machine.processor}, {machine.cores} cores, "
        f"{machine.memory_gib:.0f} GiB, {machine.system}; Python {machine.python}, {packages}; "
        f"kernels `{machine.kernels}`, compiler {machine.compiler or 'unknown'}; {commit}."
    )
    if machine.load > BUSY:
        yield (
            f"**The machine was busy**: its load was {machine.load:.1f} before the last run. Rows "
            "by the clock on the wall (one vehicle, workers, start-up) are then too slow, and all "
            "rates suffer from sharing caches and memory: measure again on a quiet machine."
        )


def _summary(records: Sequence[Record]) -> Iterator[str]:
    judged = [record for record in records if record.target is not None]
    missed = [record for record in judged if record.met is False]
    yield f"Targets met: {sum(record.met is True for record in judged)} of {len(judged)}."
    if missed:
        rows = [
            f"- {record.name}: {_reached(record)}, asked {_target(record.target)}"
            for record in missed
        ]
        yield "Missed:\n\n" + "\n".join(rows)
    yield "![Ratios of speed against other software, with the targets](images/performance.svg)"


def _reached(record: Record) -> str:
    if record.target is not None and record.target.of == "ratio":
        return f"ratio {_ratio(record)}"
    return f"{number(record.ours or 0.0)} {record.unit}"


def _table(records: Sequence[Record]) -> str:
    return grid(Table(columns=_COLUMNS, lines=tuple(map(_line, records))))


def _line(record: Record) -> Line:
    target = _target(record.target)
    if record.ours is None:
        return line(record.name, MISSING, MISSING, MISSING, target, MISSING)
    peer = "" if record.peer is None else f"{number(record.peer)} ({record.peer_name})"
    met = {True: Entry(text="yes"), False: Entry(text="no", tone="bad"), None: Entry(text="")}
    ours = f"{number(record.ours)} {record.unit}"
    return line(record.name, ours, peer, _ratio(record), target, met[record.met])


def _ratio(record: Record) -> str:
    if record.ratio is None:
        return ""
    if record.low is None or record.high is None:
        return number(record.ratio)
    return f"{number(record.ratio)} [{number(record.low)}, {number(record.high)}]"


def _target(target: Target | None) -> str:
    if target is None:
        return ""
    of = "" if target.of == "ratio" else " itself"
    return f"{target.sense} {number(target.value)}{of}"


def _notes(records: Sequence[Record]) -> Iterator[str]:
    notes = [f"- {record.name}: {record.note}" for record in records if record.note]
    if notes:
        yield "\n".join(notes)
