"""Blocks and picture of the page about sensors' faults."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from blocks import ROOT, Wrong
from pictures import IMAGES

from faultpath.decisions.sentences import wording
from faultpath.decisions.sentences.wording import counted
from faultpath.decisions.tables import Entry, Line, Table, line
from faultpath.decisions.tables.markdown import grid
from faultpath.report.svg import Svg, covering, tick_label

PLACE = ROOT / "experiments" / "state-errors"
SHARED = "shared"
PLACES = {
    "present": "predictor's state",
    "history": "predictor's history",
    "reconstruction": "reconstruction",
    "camera": "camera's frame",
}
TITLES = {
    "correct": "no fault",
    SHARED: "at the sensor (shared)",
    **{name: f"at the {place}" for name, place in PLACES.items()},
}
REPAIRS = {"accelerometer": "inertial observer", "withheld": "no wind input"}
"""Names of repairs in the documents, where those of the records mislead."""
SOURCES = {"sensors": "fresh", "selection": "selection"}
"""Scenes of each library, in words."""
_WIDTH, _LEFT, _TOP, _PITCH = 820.0, 420.0, 30.0, 24.0
UNITS = {"position": "m", "velocity": "m/s", "attitude": "deg", "body_rate": "rad/s"}


def _read(name: str) -> Any:
    file = PLACE / name
    if not file.is_file():
        raise Wrong(f"{file.relative_to(ROOT)} is missing: fly it as {PLACE.name}/README.md says")
    return json.loads(file.read_text("utf-8"))


def audits_of(library: str) -> Any:
    """Return the audits of a library: fault, repair, effects by place, and what is significant."""
    audits = _read(f"{library}/found.json")
    return [audit | {"repair": REPAIRS.get(audit["repair"], audit["repair"])} for audit in audits]


def _significant(audit: Mapping[str, Any]) -> bool:
    return any(effect[3] for effect in audit["effects"].values())


def _effect(effect: Sequence[float]) -> Entry:
    """Return a difference in percentage points with its interval, bold where significant."""
    value, low, high, sign = effect
    ends = ", ".join(wording.signed(end, 1) for end in (low, high))
    return Entry(text=f"{wording.signed(value, 1)} [{ends}]", detected=bool(sign))


def _rows(audits: Sequence[Mapping[str, Any]], *scenes: str) -> str:
    """Return a table of audits; `scenes` says of each on which scenes it was, or of none."""
    places = [n for n in TITLES if all(n in audit["effects"] for audit in audits)]
    columns = ("repair", *(["scenes"] if scenes else []), *(TITLES[name] for name in places))
    lines: list[Line] = []
    for index, audit in enumerate(audits):
        effects = (_effect(audit["effects"][name]) for name in places)
        lines.append(line(audit["fault"], audit["repair"], *scenes[index : index + 1], *effects))
    return grid(Table(corner="fault", columns=columns, words=columns, lines=tuple(lines)))


def _effects() -> str:
    """Return the audits of both libraries in which an effect is significant."""
    rows = [(a, words) for name, words in SOURCES.items() for a in audits_of(name)]
    rows = [(audit, words) for audit, words in rows if _significant(audit)]
    return _rows([audit for audit, _ in rows], *(words for _, words in rows))


def _rest(library: str) -> str:
    """Return a library's audits in which no effect is significant."""
    return _rows([audit for audit in audits_of(library) if not _significant(audit)])


def _success(library: str) -> str:
    """Return the baseline's success in percent, fault by fault and place by place."""
    rates = {audit["fault"]: audit["success"] for audit in audits_of(library)}
    places = [name for name in TITLES if name in next(iter(rates.values()))]
    columns = tuple(TITLES[name] for name in places)
    lines = [
        line(fault, *(wording.plain(100 * success[name][1], 0) for name in places))
        for fault, success in rates.items()
    ]
    return grid(Table(corner="fault", columns=columns, words=columns, lines=tuple(lines)))


def reading(audits: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return in sentences what is significant when shared, what isolated tests detect, the rest."""
    signs = {sign: [a for a in audits if a["effects"][SHARED][3] == sign] for sign in (1, -1, 0)}
    shared = [*signs[1], *signs[-1]]
    sentences = [
        f"Of {counted(len(audits), 'audit')} on fresh scenes with the fault at the sensor, the "
        f"repair succeeds significantly more often than the baseline in {_named(signs[1])} and "
        f"less often in {_named(signs[-1])}."
    ]
    places = [place for place in PLACES if any(place in audit["turns"] for audit in shared)]
    if places:
        tests = "; ".join(_isolated(shared, place) for place in places)
        sentences.append(f"Of these {counted(len(shared), 'difference')}, {tests}.")
    reversals = sum("reversal" in audit["turns"].values() for audit in audits)
    start = f"A reversal was found in {reversals}"
    if not reversals:
        start = "No reversal was found, which does not show that there is none"
    return [*sentences, f"{start}; inconclusive with the fault at the sensor: {_named(signs[0])}."]


def _named(audits: Sequence[Mapping[str, Any]]) -> str:
    names = wording.series(
        [f"{audit['repair']} under {audit['fault']}" for audit in audits] or [""]
    )
    return f"{len(audits)} ({names})" if names else "none"


def _isolated(audits: Sequence[Mapping[str, Any]], place: str) -> str:
    """Return in how many audits a test at one place detects what is significant when shared."""
    same = sum(a["effects"][place][3] == a["effects"][SHARED][3] for a in audits)
    differ = sum(a["turns"].get(place, "none") != "none" for a in audits)
    return (
        f"a test {TITLES[place]} alone detects {same or 'none'} "
        f"(significantly different from the shared effect: {differ or 'none'})"
    )


def pictures() -> Mapping[Path, str]:
    """Return the picture of the fresh scenes' audits, by its path."""
    audits = audits_of("sensors")
    rows = [
        (audit, name) for audit in audits for name in (SHARED, *audit["turns"]) if name != "correct"
    ]
    ends = [end for audit, name in rows for end in audit["effects"][name][:3]]
    text = " ".join(reading(audits))
    svg = Svg(_WIDTH, _TOP + _PITCH * len(rows) + 40, "Repairs under faults of sensors", text)
    axis = covering(ends, least=10.0).at(_LEFT, _WIDTH - 8)
    zero, bottom = axis(0.0), _TOP + _PITCH * len(rows)
    svg.text(zero - 8, 14, "← baseline better", "small baseline", "end")
    svg.text(zero + 8, 14, "repair better →", "small repair", "start")
    for tick in axis.ticks(8):
        svg.line((axis(tick), _TOP - 6), (axis(tick), bottom), "axis" if tick else "zero")
        svg.text(axis(tick), bottom + 16, tick_label(tick), "small soft", "middle")
    svg.text((axis.start + axis.end) / 2, bottom + 34, "success, pp", "small soft", "middle")
    for index, (audit, name) in enumerate(rows):
        y = _TOP + _PITCH * index + 10
        value, low, high, sign = audit["effects"][name]
        if name == SHARED:
            svg.text(0, y + 4, f"{audit['repair']}, {audit['fault']}", "bold")
        svg.text(
            _LEFT - 10, y + 4, TITLES[name], "small" if name == SHARED else "small soft", "end"
        )
        side = {1: " repair", -1: " baseline", 0: ""}[sign]
        svg.line((axis(low), y), (axis(high), y), f"range{side}")
        svg.circle((axis(value), y), 4.5, f"dot{side}" if side else "dot open")
    return {IMAGES / "state-errors.svg": svg.render(standalone=True) + "\n"}


def _picture() -> str:
    return "![Repairs under faults of sensors, on fresh scenes]({images}/state-errors.svg)"


def _reading() -> str:
    return " ".join(reading(audits_of("sensors")))


def _errors(library: str) -> str:
    """Return how large the recorded errors are that are delivered to one module."""
    columns = ("filter", *(f"{name.replace('_', ' ')}, {unit}" for name, unit in UNITS.items()))
    lines = [
        line(row["fault"], row["filter"], *(wording.plain(row["rms"][name], 3) for name in UNITS))
        for row in _read(f"{library}/errors.json")
    ]
    return grid(Table(corner="fault", columns=columns, words=columns, lines=tuple(lines)))


def _map() -> str:
    cells = _read("map.json")["cells"]
    scales, errors = (list(dict.fromkeys(n.split(",")[i] for n in cells)) for i in (0, 1))
    columns = tuple(f"calibration {100 * float(error):+g} %" for error in errors)
    lines = [
        line(
            f"accelerometer scale {100 * float(scale):+g} %",
            *(_effect(cells[f"{scale},{error}"]["effect"]) for error in errors),
        )
        for scale in scales
    ]
    significant = sum(bool(cell["effect"][3]) for cell in cells.values())
    return (
        f"{grid(Table(corner='', columns=columns, words=columns, lines=tuple(lines)))}\n\n"
        f"Significant: {significant or 'none'} of {len(cells)}."
    )


def _accuracy() -> str:
    accuracy = _read("accuracy.json")
    columns = tuple(f"{name.replace('_', ' ')}, {unit}" for name, unit in UNITS.items())
    lines = [
        line(kind, *(wording.plain(accuracy[kind][name], 3) for name in UNITS))
        for kind in ("eskf", "eskf-no-bias", "eskf-cautious")
    ]
    return grid(Table(corner="filter", columns=columns, words=columns, lines=tuple(lines)))


def _cost() -> str:
    pace = _read("accuracy.json")["step_ms"]
    more = 100.0 * (pace["eskf"] / pace["exact"] - 1.0)
    return (
        f"A control step of 50 scenes takes {wording.plain(pace['eskf'], 1)} ms with the filter "
        f"and {wording.plain(pace['exact'], 1)} ms without: {wording.plain(more, 0)} % more."
    )


KIND: Mapping[str, Callable[..., str]] = {
    "effects": _effects,
    "rest": _rest,
    "success": _success,
    "reading": _reading,
    "errors": _errors,
    "map": _map,
    "accuracy": _accuracy,
    "cost": _cost,
    "picture": _picture,
}
