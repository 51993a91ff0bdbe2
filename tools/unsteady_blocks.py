"""What `tools/unsteady_wind.py` found, as a block of the page on the paper."""

from collections.abc import Iterator, Mapping
from functools import partial

from blocks import REFERENCE, TAKE_AGAIN, parsed
from machine import Machine

from faultpath.record import DecisionRecord
from faultpath.record.family import CORRECT, SHARED
from faultpath.report import wording
from faultpath.studies.entries import bracket
from faultpath.studies.pages.table_4 import NAMES, paper_contrast, paper_rate
from faultpath.studies.pages.table_6 import paper_acceleration
from faultpath.studies.published import published
from faultpath.tables import Entry, Line, Table, line
from faultpath.tables.markdown import block

RUNS = REFERENCE / "unsteady-wind"
OBSERVED, DECIDED, FLOWN = "observer.json", "decided.json", "flown.json"
WINDS = ("frozen", "unsteady")
WANTED = paper_acceleration("dob", CORRECT)
"""The acceleration error of the paper's observer under correct inputs, m/s^2."""
PATHS = {
    CORRECT: (CORRECT, "Correct inputs"),
    "reconstruction": ("reconstruction-only", "Reconstruction only"),
    SHARED: (SHARED, "Shared"),
}
"""What the paper's table calls a path of the audit, and what this one does."""
_again = partial(parsed, again=TAKE_AGAIN)


class Observed(Machine):
    """How the observer errs, by how many times stronger turbulence and gusts are."""

    error: dict[float, float]
    table_6: dict[str, dict[str, dict[str, float]]]
    """Errors of all reconstructions in the wind as it is frozen, and in the chosen one."""

    @property
    def chosen(self) -> float:
        """How many times: the one at which the error is nearest the paper's."""
        return nearest(self.error)


def nearest(errors: Mapping[float, float]) -> float:
    """Return how many times stronger the observer errs most nearly as the paper's."""
    return min(errors, key=lambda times: abs(errors[times] - WANTED))


def found() -> Observed:
    """Return how the observer errs."""
    return _again(RUNS / OBSERVED, Observed)


def record(wind: str, kind: str) -> DecisionRecord:
    """Return what was decided in one wind of the `repair`, or of the wind `input`."""
    return _again(RUNS / wind / kind / DECIDED, DecisionRecord)


def fill() -> str:
    """Return the block of the page."""
    if not (RUNS / OBSERVED).exists():
        return "*Not flown yet: run `python tools/unsteady_wind.py FOLDER`.*"
    observed, asked = found(), record("frozen", "repair").question
    table = Table(
        title="GRU+DCC minus GRU in a wind less steady, L3",
        columns=("As frozen", f"Turbulence and gusts × {observed.chosen:g}", "The paper"),
        lines=tuple(_lines(observed)),
        notes=(
            f"{asked.n_scenes} scenes of the {asked.library} library, {wording.seeds(asked.seeds)}"
            "; zero and true wind: seed 0. Bold: detected, by the audit of its own wind, after "
            "Holm's correction. No test compares the two winds.",
            "Models that see wind in training were fitted again for the less steady one. Errors: "
            "as in Table VI (a), on windows of the selection library. Intervals, 95 %: for these "
            "trained models.",
            "Tried: "
            + "; ".join(
                f"× {times:g}, observer {wording.plain(error, 2)} m/s²"
                for times, error in observed.error.items()
            )
            + ", on windows that it flew itself.",
        ),
    )
    made = "Made by `python tools/unsteady_wind.py FOLDER`."
    return f"{block(table)}\n\nFlown {observed.words}. {made}"


def _lines(observed: Observed) -> Iterator[Line]:
    yield line("Error of the acceleration, correct inputs (m/s²)")
    for method, name in NAMES.items():
        ours = [wording.plain(observed.table_6[wind][method][CORRECT], 2) for wind in WINDS]
        yield line(name, *ours, wording.plain(paper_acceleration(method, CORRECT), 2))
    yield line("Success, correct inputs (%)")
    paper = partial(published, "table_3_wind", "obstacles")
    for variant, name, theirs in (
        ("zero-wind", "Zero wind", paper("wind-conditioned/zero", 2)),
        ("true-wind", "Ground-truth wind", paper("wind-conditioned/ground-truth", 2)),
    ):
        ours = [_rate(record(wind, "input"), variant) for wind in WINDS]
        yield line(name, *ours, wording.plain(float(theirs)))
    for variant in ("gru", "gru+dcc"):
        ours = [_rate(record(wind, "repair"), variant) for wind in WINDS]
        yield line(NAMES[variant], *ours, wording.plain(float(paper_rate(variant, CORRECT))))
    yield line("GRU+DCC minus GRU, success (pp)")
    for path, (theirs, name) in PATHS.items():
        printed = paper_contrast("gru+dcc", "gru", theirs)
        assert printed.interval is not None
        said = f"{wording.signed(printed.value)} {bracket(printed.interval)}"
        yield line(name, *(_effect(record(wind, "repair"), path) for wind in WINDS), said)


def _rate(of: DecisionRecord, variant: str) -> str:
    """Return success under correct inputs in percent."""
    cell = next(each for each in of.cells if (each.variant, each.path) == (variant, CORRECT))
    return wording.plain(100 * cell.success / cell.trials)


def _effect(of: DecisionRecord, path: str) -> Entry:
    effect = next(each for each in of.effects if each.path == path)
    return Entry(text=wording.with_interval(effect.success), detected=effect.detected)
