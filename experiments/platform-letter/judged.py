"""The quantities that are matched, what is flown for them, and how far they are off.

All are baselines on the selection library: no repair, no fault on a reconstruction, no
trajectory GRU, no freezing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from faultpath_quadrotor.paper.cells import published

from faultpath.core.streams import generator

FREE = {"environment": "free-space"}
TRUE = {"clearance": "true"}


def _cell(variant: str, wind: str = "L0", **more: Any) -> dict[str, Any]:
    options = {"wind": wind, **more.pop("options", {})}
    return {"variant": variant, "options": options, **more}


COMMON = {
    "dki": ("position-error", "dki"),
    "wm-a": ("position-error", "wm-a"),
    "wm-a +0.1": ("position-error", "wm-a", "calibration=+0.1"),
    "wm-a -0.1": ("position-error", "wm-a", "calibration=-0.1"),
}
CELLS: dict[str, dict[str, Any]] = {
    "true-parameter": _cell(
        "true-parameter", measured={**COMMON, "own": ("position-error", "true-parameter")}
    ),
    "DKI": _cell("dki", measured={"own": ("position-error", "dki")}),
    "WM-A": _cell("wm-a", measured={"own": ("position-error", "wm-a")}),
    "WM-A, true clearance": _cell(
        "wm-a", options=TRUE, measured={"own": ("position-error", "wm-a")}
    ),
    "true-parameter, true clearance": _cell(
        "true-parameter", options=TRUE, measured={"own": ("position-error", "true-parameter")}
    ),
    "WM-A, e = +0.1": _cell("wm-a", fault="calibration=+0.1", seeds=True),
    "WM-A, e = -0.1": _cell("wm-a", fault="calibration=-0.1", seeds=True),
}
for _name, _variant in (
    ("zero", "wm-a-wind/zero-wind"),
    ("truth", "wm-a-wind/true-wind"),
    ("withheld", "wm-a-nowind"),
    ("GRU", "wm-a-wind/gru"),
):
    for _level in ("L0", "L2", "L3") if _name == "GRU" else ("L2", "L3"):
        CELLS[f"{_name}, {_level}"] = _cell(_variant, _level)
        CELLS[f"{_name}, {_level}, free"] = _cell(_variant, _level, options=FREE)
for _name in ("zero", "withheld"):
    CELLS[f"{_name}, L3, free"]["seeds"] = True
for _level in ("L0", "L2", "L3"):
    del CELLS[f"GRU, {_level}, free"]
CELLS["GRU, L3"]["seeds"] = True
CELLS["GRU, L3"]["measured"] = {
    "dob": ("acceleration-error", "dob"),
    "gru": ("acceleration-error", "gru"),
}
STAND_INS: dict[str, dict[str, Any]] = {
    "DKI": CELLS["DKI"],
    "true-parameter": _cell(
        "true-parameter",
        measured={
            "dki": ("position-error", "dki"),
            "own": ("position-error", "true-parameter"),
            "wm-a +0.1": ("position-error", "true-parameter", "calibration=+0.1"),
            "wm-a -0.1": ("position-error", "true-parameter", "calibration=-0.1"),
        },
    ),
    "true-parameter, true clearance": CELLS["true-parameter, true clearance"],
    "WM-A, e = +0.1": _cell("true-parameter", fault="calibration=+0.1"),
    "WM-A, e = -0.1": _cell("true-parameter", fault="calibration=-0.1"),
    "zero, L2": _cell("dki-drag/zero-wind", "L2"),
    "zero, L3": _cell("dki-drag/zero-wind", "L3"),
    "zero, L3, free": _cell("dki-drag/zero-wind", "L3", options=FREE),
    "truth, L3": _cell(
        "dki-drag/true-wind", "L3", measured={"dob": ("acceleration-error", "dki-drag/dob")}
    ),
}
"""What flies where nothing is fitted: physics with drag for the fitted predictor."""
WITH_GRU = STAND_INS | {
    "GRU, L3": _cell(
        "dki-drag/gru",
        "L3",
        measured={
            "dob": ("acceleration-error", "dki-drag/dob"),
            "gru": ("acceleration-error", "dki-drag/gru"),
        },
    ),
}
"""With the reconstruction fitted alone."""


@dataclass(frozen=True)
class Quantity:
    """Something that the paper prints of a baseline."""

    group: str
    name: str
    cell: str
    kind: str
    """`success` and `crash` are shares, `time` in s, `error` a median."""
    target: float
    label: str = ""
    """Of an error: which one of the cell's."""
    tolerance: float = 0.0
    """Of an error, beside the relative one, in its unit."""


def quantities() -> list[Quantity]:
    """Return all of them, with the paper's figures."""
    first, second, third = (
        partial(published, name)
        for name in ("table_1_prediction_accuracy", "table_2_calibration", "table_3_wind")
    )
    sixth = partial(published, "table_6_compensation", "a_analytic_acceleration_error_mps2")
    rows = {
        "DKI": "DKI",
        "WM-A": "WM-A",
        "true-parameter": "true-parameter",
        "WM-A, true clearance": "WM-A/true-clearance",
        "true-parameter, true clearance": "true-parameter/true-clearance",
    }
    cm = 0.01
    found = [
        Quantity(
            "accuracy",
            f"common error, {row}",
            "true-parameter",
            "error",
            first(row, "error_common_cm") * cm,
            model,
            cm,
        )
        for row, model in (("DKI", "dki"), ("WM-A", "wm-a"))
    ]
    found += [
        Quantity(
            "accuracy",
            f"own error, {cell}",
            cell,
            "error",
            first(row, "error_own_cm") * cm,
            "own",
            cm,
        )
        for cell, row in rows.items()
    ]
    found += [
        Quantity("outcomes", f"{kind}, {cell}", cell, kind, first(row, kind) / 100)
        for kind in ("success", "crash")
        for cell, row in rows.items()
    ]
    found += [
        Quantity("times", f"time, {cell}", cell, "time", first(row, "time_s"))
        for cell, row in rows.items()
    ]
    for sign, place in (("+", 2), ("-", 0)):
        cell = f"WM-A, e = {sign}0.1"
        found.append(
            Quantity(
                "calibration", f"success, {cell}", cell, "success", second("WM-A", place) / 100
            )
        )
        error = second("WM-A_seed0", "error_cm", place) * cm
        found.append(
            Quantity(
                "calibration",
                f"common error, {cell}",
                "true-parameter",
                "error",
                error,
                f"wm-a {sign}0.1",
                cm,
            )
        )
    inputs = {
        "zero": "wind-conditioned/zero",
        "truth": "wind-conditioned/ground-truth",
        "withheld": "wind-withheld/none",
        "GRU": "wind-conditioned/GRU",
    }
    for cell in CELLS:
        name, _, where = cell.partition(", ")
        if name in inputs:
            level, free = where[:2], where.endswith("free")
            row = ("free_space" if free else "obstacles", inputs[name])
            share = third(*row, ("L0", "L2", "L3").index(level)) / 100
            found.append(Quantity("wind", f"success, {cell}", cell, "success", share))
    for name, label in (("DOB", "dob"), ("GRU", "gru")):
        found.append(
            Quantity(
                "reconstruction",
                f"acceleration error, {name}",
                "GRU, L3",
                "error",
                sixth(name, 0),
                label,
                0.05,
            )
        )
    return found


PAPER_SCENES = 100
RATE_TOLERANCE = 0.03
TOLERANCE = 0.10
"""Of errors and times, relative."""
CAP = 5.0
"""Largest departure that counts: one quantity out of reach must not hide all others."""
RESAMPLES = 400


def judged(
    flown: Mapping[str, Sequence[dict[str, Any]]], asked: Sequence[Quantity]
) -> dict[str, Any]:
    """Return each quantity with its standard error and departure, and the distance.

    The distance is the mean over groups of the mean squared departure in each. A departure is the
    difference over the root of three squares: the standard error here, that of the paper, and the
    tolerance; at most `CAP`. Errors and times differ by their logarithm. What cannot be told, as a
    time without success, departs by `CAP`.
    """
    rows = {q.name: _judge(q, flown[q.cell]) for q in asked}
    groups: dict[str, list[float]] = {}
    for quantity in asked:
        groups.setdefault(quantity.group, []).append(rows[quantity.name]["departure"] ** 2)
    parts = {name: round(float(np.mean(squares)), 4) for name, squares in groups.items()}
    distance = round(float(np.mean(list(parts.values()))), 4)
    return {"distance": distance, "groups": parts, "quantities": rows}


def _judge(asked: Quantity, blocks: Sequence[dict[str, Any]]) -> dict[str, Any]:
    if asked.kind in ("success", "crash"):
        return _share(asked, [status for block in blocks for status in block["status"]])
    if asked.kind == "time":
        groups = [
            [time]
            for block in blocks
            for time, status in zip(block["time_s"], block["status"], strict=True)
            if status == "success"
        ]
    else:
        by_scene: dict[tuple[int, int], list[float]] = {}
        for number, block in enumerate(blocks):
            for scene, error in zip(*block["errors"].get(asked.label, ((), ())), strict=True):
                by_scene.setdefault((number, scene), []).append(error)
        groups = list(by_scene.values())
    return _median(asked, groups)


def _share(asked: Quantity, status: Sequence[str]) -> dict[str, Any]:
    n = len(status)
    share = sum(each == asked.kind for each in status) / n
    # Laplace's estimate keeps the error of a share of none or all above zero.
    ours, theirs = (share * n + 1) / (n + 2), (asked.target * PAPER_SCENES + 1) / (PAPER_SCENES + 2)
    error = (ours * (1 - ours) / n) ** 0.5
    paper = (theirs * (1 - theirs) / PAPER_SCENES) ** 0.5
    off = (share - asked.target) / (error**2 + paper**2 + RATE_TOLERANCE**2) ** 0.5
    return _row(asked, share, error, off)


def _median(asked: Quantity, groups: Sequence[Sequence[float]]) -> dict[str, Any]:
    if len(groups) < 3:
        return {"target": asked.target, "value": None, "standard_error": None, "departure": CAP}
    values = np.array([value for group in groups for value in group])
    median = float(np.median(values))
    stream = generator("platform-search", asked.name, 0)
    draws = [
        np.median(np.concatenate([groups[i] for i in stream.integers(0, len(groups), len(groups))]))
        for _ in range(RESAMPLES)
    ]
    error = float(np.std(draws))
    # The paper prints no error of its medians: it is taken to be as large as ours, relatively.
    least = asked.tolerance / asked.target
    relative = (2 * (error / median) ** 2 + TOLERANCE**2 + least**2) ** 0.5
    return _row(asked, median, error, float(np.log(median / asked.target)) / relative)


def _row(asked: Quantity, value: float, error: float, off: float) -> dict[str, Any]:
    off = max(-CAP, min(CAP, off))
    return {
        "target": asked.target,
        "value": round(value, 4),
        "standard_error": round(error, 4),
        "departure": round(off, 3),
    }
