"""Blocks and picture of the page about sensors' faults."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from blocks import ROOT, Wrong
from pictures import IMAGES

from faultpath.decisions import wording
from faultpath.decisions.phrases import counted
from faultpath.decisions.tables import Entry, Line, Table, line
from faultpath.decisions.tables.markdown import grid
from faultpath.report.svg import Svg, covering, tick_label

PLACE = ROOT / "experiments" / "state-errors"
SHARED = "shared"
TITLES = {
    "correct": "no fault",
    SHARED: "at the sensor: shared",
    "present": "at the predictor's present",
    "history": "at its history",
    "reconstruction": "at the reconstruction",
    "camera": "at the camera's frame",
}
SIDES = {1: "ahead", -1: "behind", 0: "not decided"}
TURNS = {
    "reversal": "The ranking is decided to be the reverse of that",
    "interaction": "The shared effect is decided to differ from that",
}
_WIDTH, _LEFT, _TOP, _PITCH = 820.0, 420.0, 30.0, 24.0
UNITS = {"position": "m", "velocity": "m/s", "attitude": "deg", "body_rate": "rad/s"}


def _read(name: str) -> Any:
    file = PLACE / name
    if not file.is_file():
        raise Wrong(f"{file.relative_to(ROOT)} is missing: fly it as {PLACE.name}/README.md says")
    return json.loads(file.read_text("utf-8"))


def audits_of(library: str) -> Any:
    """Return the audits of a library: fault, repair, effects by place, and what is decided."""
    return _read(f"{library}/found.json")


def _effect(effect: Sequence[float]) -> Entry:
    """Return a difference in percentage points with its interval, and whether it is decided."""
    value, low, high, sign = effect
    ends = ", ".join(wording.signed(end, 1) for end in (low, high))
    return Entry(text=f"{wording.signed(value, 1)} [{ends}]", detected=bool(sign))


def _effects(library: str) -> str:
    audits = audits_of(library)
    places = [name for name in TITLES if name in audits[0]["effects"]]
    columns = ("repair", *(TITLES[name] for name in places))
    lines: list[Line] = []
    for audit in audits:
        effects = (_effect(audit["effects"][name]) for name in places)
        lines.append(line(audit["fault"], audit["repair"], *effects))
    return grid(Table(corner="fault", columns=columns, words=columns, lines=tuple(lines)))


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


def said(audits: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the decisions: whether a ranking reverses, then each audit in a sentence or two."""
    turned = sum("reversal" in audit["turns"].values() for audit in audits)
    lead = "No reversal was decided" if not turned else f"A reversal was decided in {turned}"
    sentences = [f"{lead}{' in' if not turned else ' of'} {counted(len(audits), 'audit')}."]
    for audit in audits:
        sides = {name: SIDES[effect[3]] for name, effect in audit["effects"].items()}
        alone = [f"{sides[place]} {TITLES[place]}" for place in audit["turns"]]
        text = f"{audit['repair']}, {audit['fault']}: {sides[SHARED]} with the fault shared"
        text += f"; {wording.series(alone)}." if alone else "."
        for turn, words in TURNS.items():
            places = [TITLES[place] for place, of in audit["turns"].items() if of == turn]
            text += f" {words} {wording.series(places)}." if places else ""
        sentences.append(text)
    return sentences


def pictures() -> Mapping[Path, str]:
    """Return the picture of the fresh scenes' audits, by its path."""
    audits = audits_of("sensors")
    rows = [
        (audit, name) for audit in audits for name in (SHARED, *audit["turns"]) if name != "correct"
    ]
    ends = [end for audit, name in rows for end in audit["effects"][name][:3]]
    text = "; ".join(said(audits))
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
    lead = said(audits_of("sensors"))[0]
    return f"![Repairs under faults of sensors. {lead}]({{images}}/state-errors.svg)"


def _said(library: str) -> str:
    return "\n".join(f"- {sentence}" for sentence in said(audits_of(library)))


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
            f"accelerometer {100 * float(scale):+g} %",
            *(_effect(cells[f"{scale},{error}"]["effect"]) for error in errors),
        )
        for scale in scales
    ]
    return grid(Table(corner="", columns=columns, words=columns, lines=tuple(lines)))


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
    "success": _success,
    "said": _said,
    "errors": _errors,
    "map": _map,
    "accuracy": _accuracy,
    "cost": _cost,
    "picture": _picture,
}
