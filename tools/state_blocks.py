"""Blocks and picture of the page about sensors' faults."""

from collections.abc import Mapping, Sequence
from typing import Any

from blocks import Picture, effect_entry, figures_of, words_grid

from faultpath.decisions.sentences import wording
from faultpath.decisions.sentences.wording import counted
from faultpath.decisions.tables import Line, line
from faultpath.report.svg import Svg, covering, tick_label

STUDY = "state-errors"
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
UNITS = {"position": "m", "velocity": "m/s", "attitude": "deg", "body_rate": "rad/s"}
COLUMNS = tuple(f"{name.replace('_', ' ')}, {unit}" for name, unit in UNITS.items())
FILTERS = ("eskf", "eskf-no-bias", "eskf-cautious")
_WIDTH, _LEFT, _TOP, _PITCH = 820.0, 420.0, 30.0, 24.0


def audits_of(library: str) -> Any:
    """Return the audits of a library: fault, repair, effects by place, and what is significant."""
    audits = figures_of(STUDY, f"{library}/found.json")
    return [audit | {"repair": REPAIRS.get(audit["repair"], audit["repair"])} for audit in audits]


def effects() -> str:
    """Return the audits of both libraries in which an effect is significant."""
    rows = [
        (audit, (scenes,))
        for library, scenes in SOURCES.items()
        for audit in audits_of(library)
        if _significant(audit)
    ]
    return _audits(rows, "scenes")


def rest(library: str) -> str:
    """Return a library's audits in which no effect is significant."""
    return _audits([(audit, ()) for audit in audits_of(library) if not _significant(audit)])


def _significant(audit: Mapping[str, Any]) -> bool:
    return any(effect[3] for effect in audit["effects"].values())


def _audits(rows: Sequence[tuple[Mapping[str, Any], Sequence[str]]], *more: str) -> str:
    """Return a table of audits; with each come its entries of the columns `more`."""
    places = [name for name in TITLES if all(name in audit["effects"] for audit, _ in rows)]
    lines = [
        line(
            audit["fault"],
            audit["repair"],
            *words,
            *(effect_entry(audit["effects"][name]) for name in places),
        )
        for audit, words in rows
    ]
    return words_grid("fault", ("repair", *more, *(TITLES[name] for name in places)), lines)


def success(library: str) -> str:
    """Return the baseline's success in percent, fault by fault and place by place."""
    rates = {audit["fault"]: audit["success"] for audit in audits_of(library)}
    places = [name for name in TITLES if name in next(iter(rates.values()))]
    lines = [
        line(fault, *(wording.plain(100 * success[name][1], 0) for name in places))
        for fault, success in rates.items()
    ]
    return words_grid("fault", [TITLES[name] for name in places], lines)


def reading() -> str:
    """Return what the audits on fresh scenes show."""
    return " ".join(sentences(audits_of("sensors")))


def sentences(audits: Sequence[Mapping[str, Any]]) -> list[str]:
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
    names = [f"{audit['repair']} under {audit['fault']}" for audit in audits]
    return f"{len(audits)} ({wording.series(names)})" if names else "none"


def _isolated(audits: Sequence[Mapping[str, Any]], place: str) -> str:
    """Return in how many audits a test at one place detects what is significant when shared."""
    same = sum(a["effects"][place][3] == a["effects"][SHARED][3] for a in audits)
    differ = sum(a["turns"].get(place, "none") != "none" for a in audits)
    return (
        f"a test {TITLES[place]} alone shows {same or 'none'} "
        f"(significantly different from the shared effect: {differ or 'none'})"
    )


def picture() -> Picture:
    """Return the picture of the audits on fresh scenes."""
    audits = audits_of("sensors")
    rows = [
        (audit, name) for audit in audits for name in (SHARED, *audit["turns"]) if name != "correct"
    ]
    ends = [end for audit, name in rows for end in audit["effects"][name][:3]]
    bottom = _TOP + _PITCH * len(rows)
    svg = Svg(_WIDTH, bottom + 40, "Repairs under faults of sensors", reading())
    axis = covering(ends, least=10.0).at(_LEFT, _WIDTH - 8)
    svg.text(axis(0.0) - 8, 14, "← baseline better", "small baseline", "end")
    svg.text(axis(0.0) + 8, 14, "repair better →", "small repair", "start")
    for tick in axis.ticks(8):
        svg.line((axis(tick), _TOP - 6), (axis(tick), bottom), "axis" if tick else "zero")
        svg.text(axis(tick), bottom + 16, tick_label(tick), "small soft", "middle")
    svg.text((axis.start + axis.end) / 2, bottom + 34, "success, pp", "small soft", "middle")
    for index, (audit, name) in enumerate(rows):
        y = _TOP + _PITCH * index + 10
        value, low, high, sign = audit["effects"][name]
        if name == SHARED:
            svg.text(0, y + 4, f"{audit['repair']}, {audit['fault']}", "bold")
        soft = "small" if name == SHARED else "small soft"
        svg.text(_LEFT - 10, y + 4, TITLES[name], soft, "end")
        side = {1: " repair", -1: " baseline", 0: ""}[sign]
        svg.line((axis(low), y), (axis(high), y), f"range{side}")
        svg.circle((axis(value), y), 4.5, f"dot{side}" if side else "dot open")
    text = "Repairs under faults of sensors, on fresh scenes"
    return Picture(f"{STUDY}.svg", text, svg.render(standalone=True) + "\n")


def errors(library: str) -> str:
    """Return how large the recorded errors are that are delivered to one module."""
    lines = [
        line(row["fault"], row["filter"], *_sizes(row["rms"]))
        for row in figures_of(STUDY, f"{library}/errors.json")
    ]
    return words_grid("fault", ("filter", *COLUMNS), lines)


def accuracy() -> str:
    """Return how large the errors of each filter are in flight."""
    figures = figures_of(STUDY, "accuracy.json")
    return words_grid("filter", COLUMNS, [line(name, *_sizes(figures[name])) for name in FILTERS])


def _sizes(errors: Mapping[str, float]) -> list[str]:
    return [wording.plain(errors[name], 3) for name in UNITS]


def cost() -> str:
    """Return how long a control step takes with and without the filter."""
    pace = figures_of(STUDY, "accuracy.json")["step_ms"]
    more = 100.0 * (pace["eskf"] / pace["exact"] - 1.0)
    return (
        f"A control step of 50 scenes takes {wording.plain(pace['eskf'], 1)} ms with the filter "
        f"and {wording.plain(pace['exact'], 1)} ms without: {wording.plain(more, 0)} % more."
    )


def calibration_map() -> str:
    """Return the effect by the errors of a sensor and of the calibration, and what is decided."""
    cells = figures_of(STUDY, "map.json")["cells"]
    scales, errors = (list(dict.fromkeys(n.split(",")[i] for n in cells)) for i in (0, 1))
    columns = [f"calibration {100 * float(error):+g} %" for error in errors]
    lines: list[Line] = []
    for scale in scales:
        effects = (effect_entry(cells[f"{scale},{error}"]["effect"]) for error in errors)
        lines.append(line(f"accelerometer scale {100 * float(scale):+g} %", *effects))
    significant = sum(bool(cell["effect"][3]) for cell in cells.values())
    return (
        f"{words_grid('', columns, lines)}\n\nSignificant: {significant or 'none'} of {len(cells)}."
    )
