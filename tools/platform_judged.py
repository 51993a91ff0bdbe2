"""How far the baselines of a platform are off the paper's.

Every quantity has a target of the paper, a standard error of both sides, and a tolerance, because
another simulator cannot agree to within sampling.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from platform_matched import Quantity

from faultpath.streams import generator

PAPER_SCENES = 100
RATE_TOLERANCE = 0.03
TOLERANCE = 0.10
"""Of errors and times, relative."""
ERROR_TOLERANCE_M = 0.01
"""Of errors, beside it: what two discretisations of a motor may differ by in a second."""
CAP = 5.0
"""Largest departure that counts: one quantity out of reach must not hide all others."""
RESAMPLES = 400


def judged(
    asked: Sequence[Quantity], flown: Mapping[str, Sequence[dict[str, Any]]]
) -> dict[str, Any]:
    """Return each quantity with its standard error and departure, and the distance.

    `flown` has the blocks of each cell. The distance is the mean over groups of the mean squared
    departure in each. A departure is the difference over the root of three squares: the standard
    error here, that of the paper, and the tolerance; at most `CAP`. Errors and times differ by
    their logarithm. What cannot be told, as a time without success, departs by `CAP`.
    """
    rows = [_judge(quantity, flown[quantity.cell]) for quantity in asked]
    groups: dict[str, list[float]] = {}
    for quantity, row in zip(asked, rows, strict=True):
        groups.setdefault(quantity.group, []).append(row["departure"] ** 2)
    parts = {name: round(float(np.mean(squares)), 4) for name, squares in groups.items()}
    return {
        "distance": round(float(np.mean(list(parts.values()))), 4),
        "groups": parts,
        "quantities": {q.name: row for q, row in zip(asked, rows, strict=True)},
    }


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
        groups = _by_scene(asked, blocks)
    return _median(asked, groups)


def _share(asked: Quantity, status: Sequence[str]) -> dict[str, Any]:
    n = len(status)
    share = sum(each == asked.kind for each in status) / n
    # Laplace's estimate keeps the error of a share of none or all above zero.
    ours, theirs = (share * n + 1) / (n + 2), (asked.target * PAPER_SCENES + 1) / (PAPER_SCENES + 2)
    error = (ours * (1 - ours) / n) ** 0.5
    paper = (theirs * (1 - theirs) / PAPER_SCENES) ** 0.5
    off = (share - asked.target) / (error**2 + paper**2 + RATE_TOLERANCE**2) ** 0.5
    return _row(share, error, off)


def _median(asked: Quantity, groups: Sequence[Sequence[float]]) -> dict[str, Any]:
    if len(groups) < 3:
        return {"value": None, "standard_error": None, "departure": CAP}
    values = np.array([value for group in groups for value in group])
    median = float(np.median(values))
    stream = generator("platform-search", asked.name, 0)
    draws = [
        np.median(np.concatenate([groups[i] for i in stream.integers(0, len(groups), len(groups))]))
        for _ in range(RESAMPLES)
    ]
    error = float(np.std(draws))
    # The paper prints no error of its medians: it is taken to be as large as ours, relatively.
    least = ERROR_TOLERANCE_M / asked.target if asked.kind == "error" else 0.0
    relative = (2 * (error / median) ** 2 + TOLERANCE**2 + least**2) ** 0.5
    return _row(median, error, float(np.log(median / asked.target)) / relative)


def _by_scene(asked: Quantity, blocks: Sequence[dict[str, Any]]) -> list[list[float]]:
    found: dict[tuple[int, int], list[float]] = {}
    for number, block in enumerate(blocks):
        for entry in block["errors"]:
            if (entry["model"], entry["error"]) == asked.model:
                for scene, missed in zip(entry["scenes"], entry["missed_m"], strict=True):
                    found.setdefault((number, scene), []).append(missed)
    return list(found.values())


def _row(value: float, error: float, off: float) -> dict[str, Any]:
    off = max(-CAP, min(CAP, off))
    return {
        "value": round(value, 4),
        "standard_error": round(error, 4),
        "departure": round(off, 3),
    }
