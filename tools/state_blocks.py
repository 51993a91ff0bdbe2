"""What the page about sensors' faults shows of its study."""

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from blocks import ROOT, Wrong

from faultpath.decisions import wording
from faultpath.decisions.phrases import counted
from faultpath.decisions.tables import Line, Table, line
from faultpath.decisions.tables.markdown import grid

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
UNITS = {"position": "m", "velocity": "m/s", "attitude": "deg", "body_rate": "rad/s"}


def _read(name: str) -> Any:
    file = PLACE / name
    if not file.is_file():
        raise Wrong(f"{file.relative_to(ROOT)} is missing: fly it as {PLACE.name}/README.md says")
    return json.loads(file.read_text("utf-8"))


def _effect(effect: Sequence[float]) -> str:
    """Return a difference in percentage points with its interval, bold where it is decided."""
    value, low, high, sign = effect
    said, ends = wording.signed(value, 1), (wording.signed(end, 1) for end in (low, high))
    return f"{f'**{said}**' if sign else said} [{', '.join(ends)}]"


def _effects(library: str) -> str:
    found = _read(f"{library}/found.json")
    places = [name for name in TITLES if name in found[0]["effects"]]
    columns = ("repair", *(TITLES[name] for name in places))
    lines: list[Line] = []
    for each in found:
        effects = (_effect(each["effects"][name]) for name in places)
        lines.append(line(each["fault"], each["repair"], *effects, name=True))
    return grid(Table(corner="fault", columns=columns, words=columns, lines=tuple(lines)))


def _success(library: str) -> str:
    """Return the baseline's success in percent, fault by fault and place by place."""
    found = {each["fault"]: each["success"] for each in _read(f"{library}/found.json")}
    places = [name for name in TITLES if name in next(iter(found.values()))]
    columns = tuple(TITLES[name] for name in places)
    lines = [
        line(fault, *(wording.plain(100 * success[name][1], 0) for name in places), name=True)
        for fault, success in found.items()
    ]
    return grid(Table(corner="fault", columns=columns, words=columns, lines=tuple(lines)))


def said(found: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return what was decided, a sentence each; of what was not, only how much it is."""
    told: list[str] = []
    turned = [(e, place) for e in found for place, turn in e["turns"].items() if turn == "reversal"]
    for each, place in turned:
        told.append(
            f"Choose by the shared fault: with {each['fault']} {TITLES[place]} alone, "
            f"'{each['repair']}' is on the other side than with the fault shared."
        )
    if not turned:
        told.append("No reversal between one module and all of them was decided.")
    moved = [
        f"{each['repair']} ({each['fault']}, {TITLES[place]})"
        for each in found
        for place, turn in each["turns"].items()
        if turn == "interaction"
    ]
    if moved:
        told.append(
            "What a repair gains or costs is decided to be another with the fault shared than with "
            f"the same errors at one module: {'; '.join(moved)}."
        )
    ahead, behind, hidden = list[str](), list[str](), list[str]()
    for each in found:
        name = f"{each['repair']} ({each['fault']})"
        sign = each["effects"][SHARED][3]
        if sign:
            (ahead if sign > 0 else behind).append(name)
            silent = [
                TITLES[place]
                for place, effect in each["effects"].items()
                if place not in (SHARED, "correct") and not effect[3]
            ]
            if silent:
                hidden.append(f"{name}: {', '.join(silent)}")
    if ahead:
        told.append(f"With the fault shared these repairs are ahead: {'; '.join(ahead)}.")
    if behind:
        told.append(f"With the fault shared these repairs are behind: {'; '.join(behind)}.")
    if hidden:
        told.append(f"Of those, a test of one module did not decide here: {'; '.join(hidden)}.")
    undecided = len(found) - len(ahead) - len(behind)
    told.append(
        f"With the fault shared {counted(undecided, 'audit')} of {len(found)} decided nothing."
    )
    return told


def _said(library: str) -> str:
    return "\n".join(f"- {each}" for each in said(_read(f"{library}/found.json")))


def _map() -> str:
    cells = _read("map.json")["cells"]
    scales, errors = (list(dict.fromkeys(n.split(",")[i] for n in cells)) for i in (0, 1))
    columns = tuple(f"calibration {100 * float(each):+g} %" for each in errors)
    lines = [
        line(
            f"accelerometer {100 * float(scale):+g} %",
            *(_effect(cells[f"{scale},{error}"]["effect"]) for error in errors),
            name=True,
        )
        for scale in scales
    ]
    return grid(Table(corner="", columns=columns, words=columns, lines=tuple(lines)))


def _accuracy() -> str:
    found = _read("accuracy.json")
    columns = tuple(f"{name.replace('_', ' ')}, {unit}" for name, unit in UNITS.items())
    lines = [
        line(name, *(wording.plain(found[name][each], 3) for each in UNITS), name=True)
        for name in ("eskf", "eskf-no-bias", "eskf-cautious")
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
    "map": _map,
    "accuracy": _accuracy,
    "cost": _cost,
}
