"""The blocks of `docs/performance.md` from `results.json`: its words are there, its numbers here.

As in every document, `tools/documents.py` fills the blocks that are marked in it.
"""

import json
from collections.abc import Sequence
from statistics import median
from typing import Any

from benchmarks.results import DEVICE, EARLIER, WAITS, Record, load, record
from benchmarks.waits import STEPS, TESTS
from faultpath.decisions.tables import MISSING, Line, Table, line
from faultpath.decisions.tables.markdown import grid

_COLUMNS = ("faultpath", "compared with", "ratio")
_STEPS = "vehicle-steps/s"
"""Unit of the plant's rows: shown as a time, without a ratio, since the models differ."""


def all_rows() -> str:
    """Return the table of all rows of `results.json`."""
    return rows(load().records)


def rows(records: Sequence[Record]) -> str:
    """Return the table of all rows and, below it, why some were not measured."""
    table = grid(Table(columns=_COLUMNS, lines=tuple(map(_line, records))))
    notes = [f"- {record.name}: {record.note}" for record in records if record.note]
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
    then, here = load(EARLIER), {record.name: record for record in load().records}
    ratios = "; ".join(
        f"{record.name}: {_ratio(record)} there, {_ratio(here[record.name])} here"
        for record in then.records
    )
    return (
        f"On another machine ({then.machine.processor}, kernels `{then.machine.kernels}`, "
        f"{then.machine.date}) the ratios to other planners were not the same. {ratios}."
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
    if unit == _STEPS and peer:
        ours, peer, unit, ratio = 1e6 / ours, 1e6 / peer, "µs a vehicle and step", ""
    against = "" if peer is None else f"{number(peer)} ({record.peer_name})"
    return line(record.name, f"{number(ours)} {unit}", against, ratio)


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
    table = grid(Table(corner="command", columns=columns, lines=tuple(lines), words=columns[:1]))
    return f"{table}\n\nMeasured: {'; '.join(dict.fromkeys(measured))}."


def gpu() -> str:
    """Return what `device.json` holds of each GPU: steps of a flight, an audit, the paper."""
    machines = json.loads(DEVICE.read_text())
    return "\n\n".join(_gpu(name, figures) for name, figures in machines.items())


def _gpu(name: str, figures: dict[str, Any]) -> str:
    core, *blocks = figures["steps"]
    alone = [taken / core["scenes"] for taken in core["step_ms"]]
    records = []
    for block in blocks:
        busy = 100 * block["busy_ms"] / median(block["step_ms"])
        scenes = [taken / block["scenes"] for taken in block["step_ms"]]
        row = f"Control step of a scene, blocks of {block['scenes']}"
        note = f"{block['kernels']} kernels a step, computed in {number(busy)} % of the time"
        measured = record(row, "ms", scenes, alone, "one core")
        records.append(measured.model_copy(update={"note": note}))
    parts = [
        f"Measured on {figures['date']} by `{figures['command']}`: {name}, torch "
        f"{figures['torch']}; one core with kernels `{figures['kernels']}`.",
        rows(records),
    ]
    if audits := figures.get("audits"):
        here, there = audits["successes"]
        parts.append(
            f"Of {audits['trials']} trials of `make audit` on that machine, {audits['alike']} end "
            f"alike on both; {here} succeed on the processor and {there} on the GPU. The audit "
            f"finds the same on both, significant or not, on {audits['decided_alike']} of "
            f"{audits['conditions']} conditions (`{audits['command']}`)."
        )
    if paper := figures.get("paper"):
        origin = paper.get("by_hand") or f"`{paper['command']}`"
        parts.append(
            f"`{paper['runs']}`, {paper['trials']} trials, took {paper['cpu_s']:.0f} s with "
            f"`--workers {paper['cores']}` on the {paper['cores']} cores of that machine and "
            f"{paper['gpu_s']:.0f} s with `--device cuda` on its GPU "
            f"({origin})."
        )
    return "\n\n".join(parts)
