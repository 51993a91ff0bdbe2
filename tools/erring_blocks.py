"""What `tools/erring_reconstructions.py` found, as a block of the page on the paper."""

from collections.abc import Iterator, Mapping
from functools import partial
from typing import TypeVar

from blocks import REFERENCE, TAKE_AGAIN, parsed
from machine import Machine

from faultpath.record import DecisionRecord, wording
from faultpath.record.family import CORRECT, SHARED
from faultpath.studies.entries import bracket
from faultpath.studies.pages.table_4 import NAMES, paper_contrast, paper_rate
from faultpath.studies.pages.table_6 import paper_acceleration
from faultpath.studies.published import published
from faultpath.tables import MISSING, Entry, Line, Table, line
from faultpath.tables.markdown import block

N = TypeVar("N", int, float)
RUNS = REFERENCE / "erring-reconstructions"
ERRORS, DECIDED = "errors.json", "decided.json"
CONDITIONS = ("frozen", "unsteady", "few-flights")
REPAIR = (*(f"{condition}/repair" for condition in CONDITIONS), "few-flights/held-out")
INPUT = ("frozen/input", "unsteady/input")
PATHS = {
    CORRECT: (CORRECT, "Correct inputs"),
    "reconstruction": ("reconstruction-only", "Reconstruction only"),
    SHARED: (SHARED, "Shared"),
}
"""What the paper's table calls a path of the audit, and what this one does."""


class Erring(Machine):
    """How reconstructions err under correct inputs, by what was tried, m/s^2."""

    winds: dict[float, float]
    """The observer, by how many times stronger turbulence and gusts are."""
    flights: dict[int, float]
    """The GRU of seed 0, by how many training flights in wind it had."""
    table_6: dict[str, dict[str, dict[str, float]]]
    """Errors of all reconstructions in each condition."""


def less_steady(winds: Mapping[float, float]) -> float:
    """Return how many times stronger the observer errs most nearly as the paper's."""
    return _nearest(winds, "dob")


def few_flights(flights: Mapping[int, float]) -> int:
    """Return with how many flights the GRU errs most nearly as the paper's."""
    return _nearest(flights, "gru")


def _nearest(errors: Mapping[N, float], method: str) -> N:
    paper = paper_acceleration(method, CORRECT)
    return min(errors, key=lambda tried: abs(errors[tried] - paper))


def record(place: str) -> DecisionRecord:
    """Return what was decided in a condition: `frozen/repair`, `frozen/input`."""
    return parsed(RUNS / place / DECIDED, DecisionRecord, TAKE_AGAIN)


def fill() -> str:
    """Return the block of the page."""
    if not (RUNS / ERRORS).exists():
        return "*Not flown yet: run `python tools/erring_reconstructions.py FOLDER`.*"
    found, asked = parsed(RUNS / ERRORS, Erring, TAKE_AGAIN), record(REPAIR[0]).question
    few = f"{few_flights(found.flights):,} training flights in wind"
    table = Table(
        title="GRU+DCC minus GRU where reconstructions err more, L3",
        columns=(
            "As frozen",
            f"Turbulence and gusts × {less_steady(found.winds):g}",
            few,
            f"{few}, held-out",
            "The paper",
        ),
        lines=tuple(_lines(found)),
        notes=(
            f"{asked.n_scenes} scenes of the {asked.library} library unless said otherwise, "
            f"{wording.seeds(asked.seeds)}; zero and true wind: seed 0. Bold: detected, by the "
            "audit of its own column, after Holm's correction. No test compares the columns.",
            "Errors: as in Table VI (a), on windows of the selection library. Intervals, 95 %: "
            "for these trained models.",
            f"Tried, turbulence and gusts: {_tried(found.winds, '× {:g}')} (the observer's error, "
            "on windows that it flew itself).",
            f"Tried, flights: {_tried(found.flights, '{:,}')} (that of the GRU of seed 0).",
        ),
    )
    made = "Made by `python tools/erring_reconstructions.py FOLDER`."
    return f"{block(table)}\n\nFinished {found.words}. {made}"


def _tried(errors: Mapping[N, float], words: str) -> str:
    return "; ".join(f"{words.format(n)}: {wording.plain(e, 2)}" for n, e in errors.items())


def _lines(found: Erring) -> Iterator[Line]:
    yield line("Error of the acceleration, correct inputs (m/s²)")
    for method, name in NAMES.items():
        ours = [wording.plain(found.table_6[each][method][CORRECT], 2) for each in CONDITIONS]
        yield line(name, *ours, MISSING, wording.plain(paper_acceleration(method, CORRECT), 2))
    yield line("Success, correct inputs (%)")
    paper = partial(published, "table_3_wind", "obstacles")
    for variant, name, theirs in (
        ("zero-wind", "Zero wind", paper("wind-conditioned/zero", 2)),
        ("true-wind", "Ground-truth wind", paper("wind-conditioned/ground-truth", 2)),
    ):
        ours = [_rate(record(each), variant) for each in INPUT]
        yield line(name, *ours, MISSING, MISSING, wording.plain(float(theirs)))
    for variant in ("gru", "gru+dcc"):
        ours = [_rate(record(each), variant) for each in REPAIR]
        yield line(NAMES[variant], *ours, wording.plain(float(paper_rate(variant, CORRECT))))
    yield line("GRU+DCC minus GRU, success (pp)")
    for path, (theirs, name) in PATHS.items():
        printed = paper_contrast("gru+dcc", "gru", theirs)
        assert printed.interval is not None
        said = f"{wording.signed(printed.value)} {bracket(printed.interval)}"
        yield line(name, *(_effect(record(each), path) for each in REPAIR), said)


def _rate(of: DecisionRecord, variant: str) -> str:
    cell = next(each for each in of.cells if (each.variant, each.path) == (variant, CORRECT))
    return wording.plain(100 * cell.success / cell.trials)


def _effect(of: DecisionRecord, path: str) -> Entry:
    effect = next(each for each in of.effects if each.path == path)
    return Entry(text=wording.with_interval(effect.success), detected=effect.detected)
