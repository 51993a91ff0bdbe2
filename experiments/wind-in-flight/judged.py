"""Quantities that are matched, what is flown for them, and how far they are off.

Every figure that the paper prints of a baseline, under correct inputs and under its faults, on the
selection library. Unseen: every +DCC, the observer in flight, the trajectory GRU, calibration
withheld from the reconstruction, freezing, negative offsets of reconstructions, probes. Left out:
ranges over seeds, intervals, and the subset of 30 scenes of Table III, which repeat other rows.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from faultpath_paper.cells import published

from faultpath.core.streams import generator

FREE = {"environment": "free-space"}
TRUE = {"clearance": "true"}


def _cell(variant: str, wind: str = "L0", **more: Any) -> dict[str, Any]:
    options = {"wind": wind, **more.pop("options", {})}
    return {"variant": variant, "options": options, **more}


COMMON = {
    "dki": ("position-error", "dki"),
    "wm-a": ("position-error", "wm-a"),
    "wm-u": ("position-error", "wm-u"),
    "wm-a +0.1": ("position-error", "wm-a", "calibration=+0.1"),
    "wm-a -0.1": ("position-error", "wm-a", "calibration=-0.1"),
}
ROWS = {
    "DKI": ("dki", False),
    "WM-A": ("wm-a", False),
    "WM-U": ("wm-u", False),
    "true-parameter": ("true-parameter", False),
    "WM-A/true-clearance": ("wm-a", True),
    "true-parameter/true-clearance": ("true-parameter", True),
}
"""Table I: variant, and whether the clearance is the true one."""
INPUTS = {
    "withheld": ("wm-a-nowind", "wind-withheld/none"),
    "zero": ("wm-a-wind/zero-wind", "wind-conditioned/zero"),
    "GRU": ("gru", "wind-conditioned/GRU"),
    "truth": ("wm-a-wind/true-wind", "wind-conditioned/ground-truth"),
}
"""Table III: variant, and the paper's row. `gru` flies with the predictor of seed 0."""


def _cells() -> dict[str, dict[str, Any]]:
    cells: dict[str, dict[str, Any]] = {}
    for row, (variant, clear) in ROWS.items():
        measured = {"own": ("position-error", variant)}
        if row == "true-parameter":
            measured |= COMMON
        options = TRUE if clear else {}
        cells[row] = _cell(variant, options=options, measured=measured, seeds=row in MODELS)
    for model in MODELS:
        for sign in SIGNS:
            cells[f"{model}, e = {sign}"] = _cell(
                model.lower(), fault=f"calibration={sign}", seeds=True
            )
    for name, (variant, _) in INPUTS.items():
        for level in LEVELS:
            if name == "truth" and level == "L0":
                continue  # the paper's own runs of a zero input
            cells[f"{name}, {level}"] = _cell(variant, level)
            cells[f"{name}, {level}, free"] = _cell(variant, level, options=FREE)
    for name in ("withheld, L3, free", "zero, L3, free", "GRU, L3"):
        cells[name]["seeds"] = True
    cells["GRU, L3"]["measured"] = {
        "dob": ("acceleration-error", "dob"),
        "gru": ("acceleration-error", "gru"),
        "conditioned": ("position-error", "wm-a-wind/true-wind"),
        "withheld": ("position-error", "wm-a-nowind"),
    }
    for name, fault in PATHS.items():
        cells[f"GRU, {name}"] = _cell("gru", "L3", fault=fault, seeds=True)
    return cells


MODELS = ("WM-A", "WM-U")
SIGNS = ("-0.1", "+0.1")
LEVELS = ("L0", "L2", "L3")
PATHS = {
    "reconstruction only": "calibration=+0.1@reconstruction",
    "shared": "calibration=+0.1",
}
CELLS = _cells()


@dataclass(frozen=True)
class Quantity:
    """Figure that the paper prints of a baseline."""

    table: str
    name: str
    cell: str
    kind: str
    """`success`, `crash` and `timeout` are shares, `time` in s, `paired` a difference of times in
    s, `error` a median."""
    target: float
    label: str = ""
    """Of an error: which one of the cell's."""
    tolerance: float = 0.0
    """Of an error, beside the relative one, in its unit."""
    first_seed: bool = False
    """Whether the paper prints it of seed 0 alone, where the cell flies with three."""

    @property
    def weight(self) -> float:
        """Outcomes in flight weigh twice recorded errors."""
        return 1.0 if self.kind == "error" else 2.0


def quantities() -> list[Quantity]:
    """Return all of them, with the paper's figures."""
    return [*_table_1(), *_table_2(), *_table_3(), *_table_4(), *_table_6()]


def _table_1() -> Iterator[Quantity]:
    paper, cm = partial(published, "table_1_prediction_accuracy"), 0.01
    make = partial(Quantity, "I", first_seed=True)
    for row in ROWS:
        if row in COMMON_ERRORS:
            target = paper(row, "error_common_cm") * cm
            label = COMMON_ERRORS[row]
            yield make(
                f"common error, {row}", "true-parameter", "error", target, label, tolerance=cm
            )
        target = paper(row, "error_own_cm") * cm
        yield make(f"own error, {row}", row, "error", target, "own", tolerance=cm)
        for kind in ("success", "crash", "timeout"):
            yield make(f"{kind}, {row}", row, kind, paper(row, kind) / 100)
        yield make(f"time, {row}", row, "time", paper(row, "time_s"))
    for row in ("DKI", "true-parameter"):
        target = paper("paired_time_minus_WM-A_s", row, "median")
        yield make(f"time minus WM-A's, {row}", row, "paired", target)


COMMON_ERRORS = {"DKI": "dki", "WM-A": "wm-a", "WM-U": "wm-u", "true-parameter": "own"}


def _table_2() -> Iterator[Quantity]:
    paper, cm = partial(published, "table_2_calibration"), 0.01
    for model in MODELS:
        for place, sign in enumerate(("-0.1", "0", "+0.1")):
            cell = model if sign == "0" else f"{model}, e = {sign}"
            target = paper(model, place) / 100
            yield Quantity("II", f"success, {model}, e = {sign}", cell, "success", target)
    for place, sign in enumerate(("-0.1", "0", "+0.1")):
        cell = "WM-A" if sign == "0" else f"WM-A, e = {sign}"
        target = paper("WM-A_seed0", "success", place) / 100
        name = f"success, WM-A seed 0, e = {sign}"
        yield Quantity("II", name, cell, "success", target, first_seed=True)
        if sign != "0":
            target = paper("WM-A_seed0", "error_cm", place) * cm
            name, label = f"common error, WM-A, e = {sign}", f"wm-a {sign}"
            yield Quantity("II", name, "true-parameter", "error", target, label, tolerance=cm)


def _table_3() -> Iterator[Quantity]:
    for cell in CELLS:
        name, _, where = cell.partition(", ")
        if name in INPUTS and where[:2] in LEVELS:
            place = "free_space" if where.endswith("free") else "obstacles"
            row = published("table_3_wind", place, INPUTS[name][1])
            target = row[LEVELS.index(where[:2])] / 100
            yield Quantity("III", f"success, {cell}", cell, "success", target)


def _table_4() -> Iterator[Quantity]:
    row = published("table_4_shared_calibration", "GRU")
    for cell, percent in zip(("GRU, L3", *(f"GRU, {name}" for name in PATHS)), row, strict=True):
        yield Quantity("IV", f"success, {cell}", cell, "success", percent / 100)


def _table_6() -> Iterator[Quantity]:
    paper = partial(published, "table_6_compensation", "a_analytic_acceleration_error_mps2")
    for name in ("GRU", "DOB"):
        target = paper(name, 0)
        yield Quantity(
            "VI", f"acceleration error, {name}", "GRU, L3", "error", target, name.lower(), 0.05
        )


CONSTRAINTS = {
    "conditioned_m": 0.30,
    "conditioned_over_withheld": 0.75,
    "still_air_m": 0.12,
}
"""Most that medians of 20-step errors may be: of the wind-conditioned predictor with the true wind
on the flights of GRU at L3, over that of the withheld one there, and of WM-A in still air."""


PAPER_SCENES = 100
RATE_TOLERANCE = 0.03
TOLERANCE = 0.10
"""Of errors and times, relative."""
PAIRED_TOLERANCE_S = 0.3
CAP = 3.0
"""Largest departure that counts: one figure out of reach cannot buy others."""
RESAMPLES = 400

Blocks = Sequence[dict[str, Any]]


def judged(flown: Mapping[str, Blocks], first: Mapping[str, Blocks]) -> dict[str, Any]:
    """Return each quantity with its standard error and departure, the distance, the constraints.

    The distance is the mean over tables of the weighted mean of squared departures in each. A
    departure is the difference over the root of three squares: the standard error here, that of
    the paper, and the tolerance; at most `CAP`. Errors and times differ by their logarithm. What
    cannot be told, as a time without success, departs by `CAP`. `first` holds seed 0 alone.
    """
    tables: dict[str, list[tuple[float, float]]] = {}
    rows: dict[str, Any] = {}
    for quantity in quantities():
        blocks = (first if quantity.first_seed else flown)[quantity.cell]
        row = rows[quantity.name] = _judge(quantity, blocks, first)
        tables.setdefault(quantity.table, []).append((quantity.weight, row["departure"] ** 2))
    parts = {
        name: round(sum(w * d for w, d in terms) / sum(w for w, _ in terms), 4)
        for name, terms in tables.items()
    }
    errors = {
        label: _pooled(first[cell], label)
        for cell, label in (
            ("GRU, L3", "conditioned"),
            ("GRU, L3", "withheld"),
            ("true-parameter", "wm-a"),
        )
    }
    constraints = {
        "conditioned_m": round(errors["conditioned"], 3),
        "conditioned_over_withheld": round(errors["conditioned"] / errors["withheld"], 3),
        "still_air_m": round(errors["wm-a"], 3),
    }
    return {
        "distance": round(float(np.mean(list(parts.values()))), 4),
        "tables": parts,
        "constraints": constraints,
        "sound": all(value <= CONSTRAINTS[name] for name, value in constraints.items()),
        "quantities": rows,
    }


def _pooled(blocks: Blocks, label: str) -> float:
    return float(np.median([e for block in blocks for e in block["errors"][label][1]]))


def _judge(quantity: Quantity, blocks: Blocks, first: Mapping[str, Blocks]) -> dict[str, Any]:
    if quantity.kind in ("success", "crash", "timeout"):
        return _share(quantity, blocks)
    if quantity.kind == "paired":
        return _paired(quantity, blocks, first["WM-A"])
    if quantity.kind == "time":
        return _median(quantity, [[time] for time in _times(blocks) if time is not None])
    return _errors(quantity, blocks)


def _times(blocks: Blocks) -> list[float | None]:
    return [
        time if status == "success" else None
        for block in blocks
        for time, status in zip(block["time_s"], block["status"], strict=True)
    ]


def _share(quantity: Quantity, blocks: Blocks) -> dict[str, Any]:
    by_scene: dict[int, list[bool]] = {}
    for block in blocks:
        for place, status in enumerate(block["status"]):
            by_scene.setdefault(block["first"] + place, []).append(status == quantity.kind)
    n = len(by_scene)
    share = float(np.mean([np.mean(ends) for ends in by_scene.values()]))
    # Laplace's estimate keeps the error of a share of none or all above zero. Trainings fly the
    # same scenes, so that more of them are not counted as more scenes.
    ours = (share * n + 1) / (n + 2)
    theirs = (quantity.target * PAPER_SCENES + 1) / (PAPER_SCENES + 2)
    error = (ours * (1 - ours) / n) ** 0.5
    paper = (theirs * (1 - theirs) / PAPER_SCENES) ** 0.5
    off = (share - quantity.target) / (error**2 + paper**2 + RATE_TOLERANCE**2) ** 0.5
    return _row(quantity, share, error, off)


def _paired(quantity: Quantity, blocks: Blocks, others: Blocks) -> dict[str, Any]:
    pairs = zip(_times(blocks), _times(others), strict=True)
    gaps = np.array([a - b for a, b in pairs if a is not None and b is not None])
    if len(gaps) < 3:
        return _missing(quantity)
    error = _spread_of_median(quantity, [[gap] for gap in gaps])
    median = float(np.median(gaps))
    off = (median - quantity.target) / (2 * error**2 + PAIRED_TOLERANCE_S**2) ** 0.5
    return _row(quantity, median, error, off)


def _errors(quantity: Quantity, blocks: Blocks) -> dict[str, Any]:
    """Compare a median over windows; of a model with three trainings, the mean of their medians."""
    labels = [quantity.label]
    if not quantity.first_seed:
        more = (f"{quantity.label}-{seed}" for seed in (1, 2))
        labels += [label for label in more if label in blocks[0]["errors"]]
    rows = [_median(quantity, _by_scene(blocks, label)) for label in labels]
    value = float(np.mean([row["value"] for row in rows])) if rows[0]["value"] else None
    if value is None:
        return rows[0]
    error = max(row["standard_error"] for row in rows)
    return _row(quantity, value, error, _relative(quantity, value, error))


def _by_scene(blocks: Blocks, label: str) -> list[list[float]]:
    scenes: dict[int, list[float]] = {}
    for block in blocks:
        for scene, error in zip(*block["errors"].get(label, ((), ())), strict=True):
            scenes.setdefault(scene, []).append(error)
    return list(scenes.values())


def _median(quantity: Quantity, groups: Sequence[Sequence[float]]) -> dict[str, Any]:
    if len(groups) < 3:
        return _missing(quantity)
    median = float(np.median([value for group in groups for value in group]))
    error = _spread_of_median(quantity, groups)
    return _row(quantity, median, error, _relative(quantity, median, error))


def _relative(quantity: Quantity, median: float, error: float) -> float:
    # The paper prints no error of its medians: it is taken to be as large as ours, relatively.
    least = quantity.tolerance / quantity.target
    relative = (2 * (error / median) ** 2 + TOLERANCE**2 + least**2) ** 0.5
    return float(np.log(median / quantity.target)) / relative


def _spread_of_median(quantity: Quantity, groups: Sequence[Sequence[float]]) -> float:
    stream = generator("platform-search", quantity.name, 0)
    draws = [
        np.median(np.concatenate([groups[i] for i in stream.integers(0, len(groups), len(groups))]))
        for _ in range(RESAMPLES)
    ]
    return float(np.std(draws))


def _missing(quantity: Quantity) -> dict[str, Any]:
    return {"target": quantity.target, "value": None, "standard_error": None, "departure": CAP}


def _row(quantity: Quantity, value: float, error: float, off: float) -> dict[str, Any]:
    return {
        "target": round(quantity.target, 4),
        "value": round(value, 4),
        "standard_error": round(error, 4),
        "departure": round(max(-CAP, min(CAP, off)), 3),
    }
