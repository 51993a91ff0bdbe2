"""Pictures of `docs/learning-quality.md`, as SVG, from what was measured."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from learning_curves import BOTTOM, HEIGHT, LABELS, Curve, Panel, draw, top_of

from faultpath.quadrotor.training.quality_results import (
    PredictorQuality,
    PredictorScore,
    Quality,
    ReconstructionScore,
)
from faultpath.record.wording import signed
from faultpath.report.scale import Axis, tick_label
from faultpath.report.svg import Svg

WIDTH = 880.0
LEFT = 34.0
_HALF = WIDTH / 2 + 12
ZERO_WIND = "zero"
SEEDS = "Thin lines are single seeds, thick ones their mean."


def rows_of(quality: Quality, pool: str) -> list[PredictorQuality]:
    """Return the predictors that were measured on a pool."""
    return [row for row in quality.predictors if row.pool == pool]


def horizon(quality: Quality) -> str:
    """Return the median error after each step, in still air and in wind."""
    step = quality.settings.step_s
    end = quality.settings.horizon * step

    def points(score: PredictorScore) -> list[tuple[float, float]]:
        return [(0.0, 0.0), *((step * (i + 1), e) for i, e in enumerate(score.horizon_m))]

    ticks = [(end * i / 4, f"{end * i / 4:g}") for i in range(5)]
    panels = [
        Panel(title, "time ahead, s", ticks, _curves(rows_of(quality, pool), points), dots=False)
        for title, pool in (
            ("Still air: median distance, predicted to flown position, m", "nominal"),
            ("Wind: median distance, predicted to flown position, m", "wind"),
        )
    ]
    return _pair(_same_height(panels), "Position error over the prediction horizon")


def calibration(pool: str, quality: Quality) -> str:
    """Return median and 90th percentile of the last error over the calibration error."""
    panels = _under_error(
        quality,
        rows_of(quality, pool),
        {
            "Predicted to flown position after 20 steps, median, m": "median_m",
            "Predicted to flown position, 90th percentile, m": "p90_m",
        },
    )
    return _pair(_same_height(panels), f"Position error under calibration error, {pool} pool")


def reconstruction(quality: Quality) -> str:
    """Return the error of the wind, and its vertical shift, over the calibration error."""
    panels = _under_error(
        quality,
        quality.reconstructions,
        {
            "Reconstructed minus true wind, RMS, m/s": "rmse_mps",
            "Reconstructed minus true vertical wind, mean, m/s": "vertical_shift_mps",
        },
    )
    return _pair(panels, "Reconstructed wind under calibration error")


def levels(quality: Quality) -> str:
    """Return the error of the reconstructed wind by wind level."""
    speeds = quality.settings.level_mean_mps

    def points(score: ReconstructionScore) -> list[tuple[float, float]]:
        return [(speeds[name], error) for name, error in score.by_level.items()]

    panel = Panel(
        "Reconstructed minus true wind, RMS, m/s",
        "wind level, and its mean wind in m/s",
        [(speed, f"{name}: {speed:g}") for name, speed in speeds.items()],
        _curves(quality.reconstructions, points),
    )
    svg = Svg(640, BOTTOM, "Error of the reconstructed wind by wind level", SEEDS)
    draw(svg, panel, LEFT, 640 - LABELS)
    return svg.render(standalone=True)


def clearance(quality: Quality) -> str | None:
    """Return calibration of estimated clearance, and its errors by range and visibility."""
    found: Any = quality.clearance
    if found is None:
        return None
    svg = Svg(WIDTH, BOTTOM, "Estimated against true visible clearance, and its errors")
    rows = [row for row in found["calibration"] if row["estimate_m"] is not None]
    ends = [end for row in rows for end in (row["low_m"], row["high_m"])] or [0.0, 1.0]
    across = Axis(min(ends), max(ends), LEFT + 8, 300)
    _diagonal(svg, across, rows)
    by_range = {f"{r['low_m']:g} to {r['high_m']:g} m": r for r in found["by_range"]}
    errors = [
        part["absolute_m"][-1]
        for part in (*by_range.values(), *found["by_visibility"].values())
        if part["absolute_m"] is not None
    ]
    error = Axis(0.0, 1.05 * max(errors, default=1.0), 430, WIDTH - 12)
    svg.text(340, 14, "Estimated minus true clearance, absolute, m", "head")
    _frame(svg, error)
    _whiskers(svg, error, "by distance", by_range, 48)
    _whiskers(svg, error, "by visibility", found["by_visibility"], 48 + 20 * (len(by_range) + 1.4))
    return svg.render(standalone=True)


def _diagonal(svg: Svg, across: Axis, rows: Sequence[Mapping[str, Any]]) -> None:
    """Draw the quantiles of the estimate over the truth: 5 to 95 %, 25 to 75 %, and the median."""
    up = Axis(across.low, across.high, HEIGHT, 36.0)
    svg.text(4, 14, "Estimated over true clearance, m", "head")
    for tick in across.ticks(5):
        cls = "axis" if tick else "zero"
        svg.line((across.start, up(tick)), (across.end, up(tick)), cls)
        svg.line((across(tick), up.start), (across(tick), up.end), cls)
        svg.text(across.start - 7, up(tick) + 4, tick_label(round(tick, 9)), "small soft", "end")
        svg.text(across(tick), HEIGHT + 18, tick_label(round(tick, 9)), "small soft", "middle")
    svg.text(0.5 * (across.start + across.end), BOTTOM - 4, "true, m", "small soft", "middle")

    def line(at: int) -> list[tuple[float, float]]:
        middles = [0.5 * (row["low_m"] + row["high_m"]) for row in rows]
        return [
            (across(x), min(max(up(row["estimate_m"][at]), up.end), up.start))
            for x, row in zip(middles, rows, strict=True)
        ]

    for low, high in ((0, 4), (1, 3)):
        svg.polygon([*line(low), *reversed(line(high))], "fan")
    corners = (across(across.low), up(up.low)), (across(across.high), up(up.high))
    svg.line(*corners, "zero")
    svg.path("M" + " L".join(f"{x:.2f},{y:.2f}" for x, y in line(2)), "curve repair")
    svg.text(across.end - 6, HEIGHT - 22, "median", "small repair halo", "end")
    svg.text(across.end - 6, HEIGHT - 8, "bands: 50 % and 90 %", "small soft halo", "end")


def _frame(svg: Svg, error: Axis) -> None:
    for tick in error.ticks(5):
        svg.line((error(tick), 36), (error(tick), HEIGHT), "axis" if tick else "zero")
        svg.text(error(tick), HEIGHT + 18, tick_label(round(tick, 9)), "small soft", "middle")
    words = "line 5 to 95 %, bar 25 to 75 %, dot median"
    svg.text(0.5 * (error.start + error.end), BOTTOM - 4, words, "small soft", "middle")


def _whiskers(
    svg: Svg, error: Axis, title: str, parts: Mapping[str, Mapping[str, Any]], top: float
) -> None:
    svg.text(340, top, title, "small soft")
    for i, (name, part) in enumerate(parts.items()):
        y = top + 20 * (i + 1)
        svg.text(340, y + 4, name)
        if part["absolute_m"] is None:
            svg.text(error.start + 8, y + 4, "no points", "small soft")
            continue
        least, low, middle, high, most = map(error, part["absolute_m"])
        svg.line((least, y), (most, y), "range repair")
        svg.rect(low, y - 4, high - low, 8, "repair-only", 2)
        svg.circle((middle, y), 4, "dot open")


def _under_error(quality: Quality, rows: Sequence[Any], fields: Mapping[str, str]) -> list[Panel]:
    ticks = [(error, signed(error)) for error in quality.settings.calibration_errors]

    def points(field: str) -> Callable[[Any], list[tuple[float, float]]]:
        return lambda score: [(each.error, getattr(each, field)) for each in score.under_error]

    return [
        Panel(title, "calibration error e", ticks, _curves(rows, points(field)))
        for title, field in fields.items()
    ]


def _curves(rows: Sequence[Any], points: Callable[[Any], Any]) -> list[Curve]:
    return [
        Curve(
            f"{row.name}, zero wind" if getattr(row, "wind", "") == ZERO_WIND else row.name,
            points(row.mean),
            [points(score) for score in row.seeds.values()],
        )
        for row in rows
    ]


def _same_height(panels: Sequence[Panel]) -> list[Panel]:
    high = max(top_of(panel.curves) for panel in panels)
    return [replace(panel, high=high) for panel in panels]


def _pair(panels: Sequence[Panel], title: str) -> str:
    svg = Svg(WIDTH, BOTTOM, title, SEEDS)
    for panel, left in zip(panels, (LEFT, LEFT + _HALF), strict=True):
        draw(svg, panel, left, left + _HALF - LEFT - LABELS - 24)
    return svg.render(standalone=True)


PICTURES: Mapping[str, tuple[str, Callable[[Quality], str | None]]] = {
    "horizon": ("Median position error over the horizon", horizon),
    "calibration-nominal": (
        "Position error under calibration error in still air",
        partial(calibration, "nominal"),
    ),
    "calibration-wind": (
        "Position error under calibration error in wind",
        partial(calibration, "wind"),
    ),
    "wind-levels": ("Error of the reconstructed wind by wind level", levels),
    "calibration-reconstruction": ("Reconstructed wind under calibration error", reconstruction),
    "clearance": ("Calibration and errors of the clearance model", clearance),
}
"""Pictures by name: what they show, and what draws them; `None` where nothing was measured."""
