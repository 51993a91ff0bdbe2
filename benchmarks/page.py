"""Blocks of `docs/performance.md` and of the README here: their words are there, numbers here.

As in every document, `tools/documents.py` fills the blocks that are marked in it.
"""

import json
from collections.abc import Iterator, Sequence
from typing import Any

from benchmarks.results import (
    DEVICE,
    EARLIER,
    LOOP_STEPS,
    TAPS,
    VEHICLE_STEPS,
    WAITS,
    Record,
    load,
    record,
)
from benchmarks.waits import STEPS, TESTS
from faultpath.report.tables import MISSING, Line, Table, line, markdown_grid

_COLUMNS = ("faultpath", "compared with", "ratio")
_A_STEP = {VEHICLE_STEPS: "µs a vehicle and step", LOOP_STEPS: "µs a step"}


def all_rows() -> str:
    """Return the table of all rows of `results.json`."""
    return rows(load().records)


def rows(records: Sequence[Record]) -> str:
    """Return the table of all rows and, below it, why some were not measured."""
    table = markdown_grid(Table(columns=_COLUMNS, lines=tuple(map(_line, records))))
    notes = [f"- {record.name}: {note}" for record in records for note in _notes(record)]
    return "\n\n".join([table, *(["\n".join(notes)] if notes else [])])


def summary(record: Record) -> str:
    """Return a record in one line, for the terminal."""
    if record.ours is None:
        return f"{record.name}: {record.note}"
    against = "" if record.peer is None else f" against {number(record.peer)} ({record.peer_name})"
    met = {True: ", met", False: ", MISSED", None: ""}[record.met]
    return f"{record.name}: {number(record.ours)} {record.unit}{against}, {_ratio(record)}{met}"


def machine() -> str:
    """Return machine, software and date of the measurements, in a sentence."""
    here = load().machine
    packages = ", ".join(f"{name} {version}" for name, version in here.packages.items())
    commit = f"commit `{here.commit[:12]}`" if here.commit else "no commit known"
    return (
        f"Measured on {here.date}: {here.processor}, {here.cores} cores, {here.system}; "
        f"Python {here.python}, {packages}; kernels `{here.kernels}`; {commit}."
    )


def elsewhere() -> str:
    """Return the ratios to other planners on another machine: they depend on the processor."""
    then = load(EARLIER)
    ratios = "; ".join(f"{record.name}: {_ratio(record)}" for record in then.records)
    return (
        f"On another machine ({then.machine.processor}, kernels `{then.machine.kernels}`, "
        f"{then.machine.date}) ratios to other planners differed. {ratios}."
    )


def number(value: float) -> str:
    """Return three significant digits, thousands apart."""
    if value >= 1000:
        digits = 10 ** (len(str(int(value))) - 3)
        return f"{round(value / digits) * digits:,}".replace(",", " ")
    return f"{value:.3g}"


def _line(record: Record) -> Line:
    if record.ours is None:
        return line(record.name, MISSING, MISSING, MISSING)
    ours, peer, unit, ratio = record.ours, record.peer, record.unit, _ratio(record)
    if unit in _A_STEP and peer:
        ours, peer = 1e6 / ours, 1e6 / peer
    if unit == VEHICLE_STEPS:  # the models differ, so there is no ratio
        ratio = ""
    unit = _A_STEP.get(unit, unit)
    against = "" if peer is None else f"{number(peer)} ({record.peer_name})"
    return line(record.name, f"{number(ours)} {unit}", against, ratio)


def _notes(record: Record) -> Iterator[str]:
    """Yield what is said of a row below the table."""
    if record.note:
        yield record.note
    if record.unit == LOOP_STEPS and record.ours and record.peer:
        each = (1e6 / record.ours - 1e6 / record.peer) / TAPS
        yield f"{number(each)} µs a tap and step more than the bare loop, at {TAPS} taps"


def _ratio(record: Record) -> str:
    if record.ratio is None:
        return ""
    if record.low is None or record.high is None:
        return number(record.ratio)
    return f"{number(record.ratio)} [{number(record.low)}, {number(record.high)}]"


def waits() -> str:
    """Return what each step took that a user waits for."""
    clones = json.loads(WAITS.read_text())
    steps = STEPS | TESTS
    lines = [
        line(step, steps[step], f"{number(seconds)} s", name=True)
        for clone in clones.values()
        for step, seconds in clone["seconds"].items()
    ]
    measured = (
        f"{clone['date']}, {clone['processor']}, {clone['cores']} cores, commit "
        f"`{clone['commit'][:12]}`"
        for clone in clones.values()
    )
    columns = ("what it does", "time")
    table = markdown_grid(
        Table(corner="command", columns=columns, lines=tuple(lines), words=columns[:1])
    )
    return f"{table}\n\nMeasured: {'; '.join(dict.fromkeys(measured))}."


def gpu() -> str:
    """Return what `device.json` holds: steps of a trial on each GPU, an audit, the paper."""
    machines = json.loads(DEVICE.read_text())
    columns = ("a scene", "one core", "ratio")
    lines = [entry for name, figures in machines.items() for entry in _steps(name, figures)]
    origins = "; ".join(
        dict.fromkeys(
            f"{figures['date']}, torch {figures['torch']}, one core with kernels "
            f"`{figures['kernels']}`"
            for figures in machines.values()
        )
    )
    commands = ", ".join(dict.fromkeys(f"`{figures['command']}`" for figures in machines.values()))
    parts = [
        markdown_grid(Table(corner="Control step", columns=columns, lines=tuple(lines))),
        f"Measured by {commands}: {origins}.",
    ]
    return "\n\n".join(
        [*parts, *(text for figures in machines.values() for text in _runs(figures))]
    )


def _steps(name: str, figures: dict[str, Any]) -> list[Line]:
    """Return a row for each size of block on a GPU."""
    core, *blocks = figures["steps"]
    alone = [taken / core["scenes"] for taken in core["step_ms"]]
    lines: list[Line] = []
    for block in blocks:
        scenes = [taken / block["scenes"] for taken in block["step_ms"]]
        taken = record(name, "ms", scenes, alone, "one core")
        times = (f"{number(value)} ms" for value in (taken.ours, taken.peer) if value is not None)
        size = f"{name}, blocks of {block['scenes']}"
        lines.append(line(size, *times, _ratio(taken)))
    return lines


def _runs(figures: dict[str, Any]) -> Iterator[str]:
    """Yield sentences on whole runs on the GPU of a machine and on its cores."""
    if audits := figures.get("audits"):
        here, there = audits["successes"]
        yield (
            f"Of {audits['trials']} trials of `make audit`, {audits['alike']} end alike on "
            f"processor and GPU ({here} and {there} succeed); what is significant is the same in "
            f"{audits['decided_alike']} of {audits['conditions']} conditions "
            f"(`{audits['command']}`)."
        )
    if paper := figures.get("paper"):
        origin = paper.get("by_hand") or f"`{paper['command']}`"
        yield (
            f"`{paper['runs']}`, {paper['trials']} trials: {paper['cpu_s']:.0f} s on "
            f"{paper['cores']} cores, {paper['gpu_s']:.0f} s with `--device cuda` ({origin})."
        )
