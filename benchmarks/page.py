"""Figures for `tools/templates/performance.md.j2`, and records in one line for the terminal."""

from collections.abc import Iterator
from typing import Any

from benchmarks.results import LOOP_STEPS, TAPS, VEHICLE_STEPS, Record, record
from benchmarks.waits import STEPS, TESTS
from faultpath.report.tables import MISSING

COMMANDS = STEPS | TESTS
_A_STEP = {VEHICLE_STEPS: "µs a vehicle and step", LOOP_STEPS: "µs a step"}


def summary(record: Record) -> str:
    if record.ours is None:
        return f"{record.name}: {record.note}"
    against = "" if record.peer is None else f" against {number(record.peer)} ({record.peer_name})"
    met = {True: ", met", False: ", MISSED", None: ""}[record.met]
    return f"{record.name}: {number(record.ours)} {record.unit}{against}, {ratio(record)}{met}"


def number(value: float) -> str:
    """Return three significant digits, thousands apart."""
    if value >= 1000:
        digits = 10 ** (len(str(int(value))) - 3)
        return f"{round(value / digits) * digits:,}".replace(",", " ")
    return f"{value:.3g}"


def entries(record: Record) -> tuple[str, ...]:
    """Return the row of a record: its name, ours, the peer's and the ratio."""
    if record.ours is None:
        return record.name, MISSING, MISSING, MISSING
    ours, peer, unit = record.ours, record.peer, record.unit
    if unit in _A_STEP and peer:
        ours, peer = 1e6 / ours, 1e6 / peer
    against = "" if peer is None else f"{number(peer)} ({record.peer_name})"
    beside = "" if unit == VEHICLE_STEPS else ratio(record)  # the models differ
    return record.name, f"{number(ours)} {_A_STEP.get(unit, unit)}", against, beside


def notes(record: Record) -> Iterator[str]:
    if record.note:
        yield record.note
    if record.unit == LOOP_STEPS and record.ours and record.peer:
        each = (1e6 / record.ours - 1e6 / record.peer) / TAPS
        yield f"{number(each)} µs a tap and step more than the bare loop, at {TAPS} taps"


def ratio(record: Record) -> str:
    if record.ratio is None:
        return ""
    if record.low is None or record.high is None:
        return number(record.ratio)
    return f"{number(record.ratio)} [{number(record.low)}, {number(record.high)}]"


def blocks(name: str, steps: list[Any]) -> Iterator[tuple[str, ...]]:
    """Yield a row for each size of block on a GPU."""
    alone, *others = ([taken / block["scenes"] for taken in block["step_ms"]] for block in steps)
    for block, scenes in zip(steps[1:], others, strict=True):
        taken = record(f"{name}, blocks of {block['scenes']}", "ms", scenes, alone)
        times = (f"{number(value)} ms" for value in (taken.ours, taken.peer) if value is not None)
        yield taken.name, *times, ratio(taken)
