"""The errors of two modules and their sum over time: a small picture for each path of the fault."""

from math import isfinite

import numpy as np

from faultpath.report.adding import Adding, Lines
from faultpath.report.scale import Axis, covering, draw_levels, draw_tick, tick_label
from faultpath.report.svg import Point, Svg, shortened
from faultpath.trials import Status

_WIDTH, _LEFT, _RIGHT = 308.0, 38.0, 14.0
_TOP, _PLOT, _PITCH = 44.0, 96.0, 136.0
_LINES = ("term one", "term two", "term both")
_SIGN = {Status.SUCCESS: "M-5 0l3 4l7 -9", Status.CRASH: "M-5 -5l10 10M5 -5l-10 10"}
_OTHER = "M-4 -4h8v8h-8Z"


def adding_panels(shown: Adding) -> list[str]:
    """Return a picture of each path, the baseline above the repair, all on the same axes."""
    arms = [arm for _, _, both in shown.paths for arm in both]
    upward = covering(shown.span, least=1e-9)
    clock = Axis(0.0, max(arm.time_s for arm in arms), _LEFT, _WIDTH - _RIGHT)
    return [_panel(shown, title, both, upward, clock) for _, title, both in shown.paths]


def line_key(shown: Adding) -> list[tuple[str, str]]:
    """Return a sample of each line with what it stands for."""
    found: list[tuple[str, str]] = []
    for name, cls in zip(shown.names, _LINES, strict=True):
        svg = Svg(34, 12, name)
        svg.line((1, 6), (33, 6), cls)
        found.append((svg.render(), name))
    return found


def _panel(shown: Adding, title: str, arms: tuple[Lines, ...], upward: Axis, clock: Axis) -> str:
    told = " ".join(
        f"{arm.role.capitalize()} {arm.name}: mean size "
        + ", ".join(f"{name} {size:.2g}" for name, size in zip(shown.names, arm.sizes, strict=True))
        + f" {shown.unit}; {arm.ended} after {arm.time_s:.1f} s."
        for arm in arms
    )
    name = f"{title}: {shown.words} over time, scene {shown.scene}"
    svg = Svg(_WIDTH, _TOP + _PITCH * len(arms) - 16, name, told)
    svg.text(0, 14, shortened(title, _WIDTH, 13), "head", tip=title)
    for place, arm in enumerate(arms):
        top = _TOP + _PITCH * place
        y = upward.at(top + _PLOT, top)
        _arm(svg, arm, clock, y, shown)
    bottom = _TOP + _PITCH * (len(arms) - 1) + _PLOT
    for tick in clock.ticks(4):
        draw_tick(svg, clock, Axis(0, 1, bottom, 0), tick, tick_label(tick))
    svg.text(_WIDTH, bottom + 17, "s", "small soft", "end")
    return svg.render()


def _arm(svg: Svg, arm: Lines, x: Axis, y: Axis, shown: Adding) -> None:
    svg.text(0, y.end - 10, arm.role, "small soft")
    room = 130.0
    svg.text(54, y.end - 10, shortened(arm.name, room, 12), f"bold {arm.role}", tip=arm.name)
    ended = f"{arm.ended}, {arm.time_s:.1f} s"
    svg.text(_WIDTH, y.end - 10, ended, "small soft", "end")
    draw_levels(svg, x, y, 4, zero="zero")
    svg.text(_LEFT - 6, y.start + 14, shown.unit, "small soft", "end")
    inside: list[list[float]] = np.clip(arm.values, y.low, y.high).tolist()

    def points(values: list[float]) -> list[Point]:
        steps = enumerate(values)
        return [(x(step * shown.dt_s), y(value)) for step, value in steps if isfinite(value)]

    both = points(inside[-1])
    if both:
        svg.polygon([(both[0][0], y(0)), *both, (both[-1][0], y(0))], f"left-over {arm.role}")
    for values, cls in zip(inside, _LINES, strict=True):
        svg.polyline(points(values), f"{cls} {arm.role}" if cls == _LINES[-1] else cls)
    end = x(arm.time_s)
    svg.line((end, y.start), (end, y.end), "ended")
    with svg.group(transform=f"translate({end:.1f} {y.end + 8:.1f})"):
        svg.path(_SIGN.get(arm.status, _OTHER), f"end-sign {arm.role}")
