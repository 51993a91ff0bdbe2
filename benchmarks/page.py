"""The blocks of `docs/performance.md` from `results.json`: its words are there, its numbers here.

As of every document, `tools/documents.py` fills the blocks that are marked in it.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from benchmarks.results import ROOT, Record, Target, load
from faultpath.report.svg import Axis, Svg, shortened, tick_label
from faultpath.tables import MISSING, Entry, Line, Table, line
from faultpath.tables.markdown import grid

IMAGES = ROOT / "docs" / "images"
_COLUMNS = ("faultpath", "compared with", "ratio", "target", "met")
_WIDTH, _NAMES, _ROW, _TOP = 880.0, 330.0, 24.0, 58.0


def files() -> Mapping[Path, str]:
    """Return the picture that the results decide, by its path."""
    return {IMAGES / "performance.svg": picture(load().records) + "\n"}


def rows(records: Sequence[Record]) -> str:
    """Return the table of all rows and, below it, why some were not measured."""
    table = grid(Table(columns=_COLUMNS, lines=tuple(map(_line, records))))
    notes = [f"- {record.name}: {record.note}" for record in records if record.note]
    return "\n\n".join([table, *(["\n".join(notes)] if notes else [])])


def told(record: Record) -> str:
    """Return a record in one line, for the terminal."""
    if record.ours is None:
        return f"{record.name}: {record.note}"
    against = "" if record.peer is None else f" against {number(record.peer)} ({record.peer_name})"
    met = {True: ", met", False: ", MISSED", None: ""}[record.met]
    return f"{record.name}: {number(record.ours)} {record.unit}{against}, {_ratio(record)}{met}"


def machine() -> str:
    """Return what the numbers were measured on, in a sentence."""
    here = load().machine
    packages = ", ".join(f"{name} {version}" for name, version in here.packages.items())
    commit = f"commit `{here.commit[:12]}`" if here.commit else "no commit known"
    return (
        f"Measured on {here.date}: {here.processor}, {here.cores} cores, {here.system}; "
        f"Python {here.python}, {packages}; kernels `{here.kernels}`; {commit}."
    )


def number(value: float) -> str:
    """Return three significant digits, thousands apart."""
    if value >= 1000:
        digits = 10 ** (len(str(int(value))) - 3)
        return f"{round(value / digits) * digits:,}".replace(",", " ")
    return f"{value:.3g}"


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


def picture(records: Sequence[Record]) -> str:
    """Return bars of how many times as fast faultpath is, on a logarithmic axis, with targets."""
    shown = {record: record.ratio for record in records if record.ratio}
    high = math.ceil(math.log10(max([10.0, *shown.values()])))
    across = Axis(-1.0, high, _NAMES, _WIDTH - 60.0)
    bottom = _TOP + _ROW * len(shown)
    svg = Svg(
        _WIDTH,
        bottom + 8,
        "How many times as fast faultpath is",
        "One bar a comparison; the mark on a bar's row is its target; at 1 both are as fast.",
    )
    svg.text(0, 16, "How many times as fast faultpath is as the software beside it", "head")
    svg.text(0, _TOP - 14, "1: as fast as the other; marks: targets", "small soft")
    for power in range(-1, high + 1):
        x = across(power)
        svg.line((x, _TOP - 8), (x, bottom), "zero" if power == 0 else "axis")
        svg.text(x, _TOP - 14, tick_label(10.0**power), "small soft", "middle")
    for i, (record, ratio) in enumerate(shown.items()):
        y = _TOP + _ROW * i
        named = record.peer_name.split()[0].strip(",") in record.name
        name = record.name if named else f"{record.name}, {record.peer_name}"
        svg.text(0, y + 15, shortened(name, _NAMES - 12, 12), tip=name)
        one, end = across(0.0), across(math.log10(max(ratio, 0.1)))
        look = {True: "success", False: "failed", None: "both"}[record.met]
        tip = f"{record.name}: {number(ratio)}"
        svg.rect(min(one, end), y + 4, abs(end - one), 14, look, tip=tip)
        right = max(one, end)
        if record.target is not None and record.target.of == "ratio":
            mark = across(math.log10(record.target.value))
            svg.line((mark, y + 1), (mark, y + 21), "range")
            right = max(right, mark)
        svg.text(right + 6, y + 15, number(ratio), "small")
    return svg.render(standalone=True)


KIND: Mapping[str, Callable[[], str]] = {
    "machine": machine,
    "rows": lambda: rows(load().records),
}
"""The blocks of the page."""
