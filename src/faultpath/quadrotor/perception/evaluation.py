"""How good estimated clearance is: calibration, and errors by range and by visibility."""

from collections.abc import Iterable
from itertools import pairwise
from typing import Any

import torch
from torch import Tensor

from faultpath.quadrotor.perception.labels import HIGHEST_M, LOWEST_M, between_pixels

CALIBRATION_BIN_M = 0.1
RANGES_M = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0)
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
_MOST = 10_000_000
"""What `torch.quantile` takes at once is limited; more points are thinned evenly."""


def summarise(estimate: Tensor, truth: Tensor, points: Tensor) -> dict[str, Any]:
    """Return plain data on how well estimates meet the visible-space distance.

    Errors are those of points whose truth lies strictly between the bounds: at the bounds the
    estimate is clipped and right by far.

    Args:
        estimate: `[I, Q]`, m.
        truth: `[I, Q]`, m.
        points: In the capture frame, `[I, 3, Q]`, m.

    Returns:
        JSON values. `calibration` has a row for each 0.1 m of truth: `low_m`, `high_m`, `count` and
        `estimate_m`, the quantiles of the estimate. `by_range` and `by_visibility` have rows of
        errors: `count`, `absolute_m` and `signed_m` (quantiles), and `wrong_sign` (a fraction of
        all points there). `quantiles` names the quantiles.
    """
    x, y, z = points.unbind(1)
    distance = (x * x + y * y + z * z).sqrt()
    seen = between_pixels(points.movedim(1, 0))
    places = {"in view": seen & (truth >= 0), "occluded": truth < 0, "outside": ~seen}
    return {
        "images": len(truth),
        "points": truth.numel(),
        "quantiles": list(QUANTILES),
        "overall": _errors(estimate, truth),
        "calibration": [
            {"low_m": low, "high_m": high, "count": int(here.sum())}
            | {"estimate_m": _quantiles(estimate[here])}
            for low, high, here in _bins(truth)
        ],
        "by_range": [
            {"low_m": low, "high_m": high} | _errors(estimate[here], truth[here])
            for low, high in pairwise(RANGES_M)
            for here in ((distance >= low) & (distance < high),)
        ],
        "by_visibility": {
            name: _errors(estimate[here], truth[here]) for name, here in places.items()
        },
    }


def _bins(truth: Tensor) -> Iterable[tuple[float, float, Tensor]]:
    count = round((HIGHEST_M - LOWEST_M) / CALIBRATION_BIN_M)
    place = ((truth - LOWEST_M) / CALIBRATION_BIN_M).floor()
    inside = (truth > LOWEST_M) & (truth < HIGHEST_M)
    for number in range(count):
        low = round(LOWEST_M + number * CALIBRATION_BIN_M, 6)
        yield low, round(low + CALIBRATION_BIN_M, 6), inside & (place == number)


def _errors(estimate: Tensor, truth: Tensor) -> dict[str, Any]:
    between = (truth > LOWEST_M) & (truth < HIGHEST_M)
    error = (estimate - truth)[between]
    wrong = ((estimate > 0) != (truth > 0)).float()
    return {
        "count": int(between.sum()),
        "absolute_m": _quantiles(error.abs()),
        "signed_m": _quantiles(error),
        "wrong_sign": float(wrong.mean()) if wrong.numel() else None,
    }


def _quantiles(values: Tensor) -> list[float] | None:
    if not values.numel():
        return None
    thinned = values.flatten()[:: -(-values.numel() // _MOST)].double()
    return [float(each) for each in thinned.quantile(torch.tensor(QUANTILES).double())]
