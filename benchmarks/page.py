"""The blocks of `docs/performance.md` from `results.json`: its words are there, its numbers here.

As of every document, `tools/documents.py` fills the blocks that are marked in it.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from benchmarks import pictures
from benchmarks.pictures import number
from benchmarks.quiet import QUIET, busy
from benchmarks.results import ROOT, Machine, Record, Results, Target, load
from benchmarks.table import COMPARISONS
from faultpath.tables import MISSING, Entry, Line, Table, line
from faultpath.tables.markdown import grid

IMAGES = ROOT / "docs" / "images"

_COLUMNS = ("faultpath", "compared with", "ratio", "target", "met")


def files() -> Mapping[Path, str]:
    """Return the pictures that the results decide, by their path."""
    results, order = load(), list(COMPARISONS)
    records = sorted(results.records, key=lambda record: order.index(record.comparison))
    return {
        IMAGES / "performance.svg": pictures.ratios(records) + "\n",
        IMAGES / "performance-scaling.svg": pictures.scaling(results.curves) + "\n",
    }


def rows(results: Results, *names: str) -> Iterator[str]:
    """Yield the table of some comparisons, what there is to say of its rows, and of what age."""
    records = [record for record in results.records if record.comparison in names]
    for name in names:
        asked = COMPARISONS[name]
        if results.editions.get(name, 1) < asked.edition:
            yield (
                f"**Out of date.** Since this was measured, {asked.changed}. "
                f'`make bench ARGS="--only {name}"` measures it again.'
            )
    yield grid(Table(columns=_COLUMNS, lines=tuple(map(_line, records))))
    notes = [f"- {record.name}: {record.note}" for record in records if record.note]
    if notes:
        yield "\n".join(notes)
    for name in names:
        if name in results.apart:
            yield from _machine(results.apart[name])


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
    yield busy(machine.others)
    if machine.others > QUIET:
        yield (
            "Rows by the clock on the wall (one vehicle, workers, start-up) are then too slow, and "
            "all rates suffer from sharing caches and memory: measure again on a quiet machine."
        )


def _summary(results: Results) -> Iterator[str]:
    judged = [record for record in results.records if record.target is not None]
    missed = [record for record in judged if record.met is False]
    yield f"Targets met: {sum(record.met is True for record in judged)} of {len(judged)}."
    if missed:
        yield "Missed:\n\n" + "\n".join(
            f"- {record.name}: {_reached(record)}, asked {_target(record.target)}"
            for record in missed
        )


def _reached(record: Record) -> str:
    if record.target is not None and record.target.of == "ratio":
        return f"ratio {_ratio(record)}"
    return f"{number(record.ours or 0.0)} {record.unit}"


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


KIND: Mapping[str, Callable[..., str]] = {
    "machine": lambda: "\n\n".join(_machine(load().machine)),
    "summary": lambda: "\n\n".join(_summary(load())),
    "rows": lambda *names: "\n\n".join(rows(load(), *names)),
}
"""The blocks of the page; `rows` takes the names of comparisons."""
