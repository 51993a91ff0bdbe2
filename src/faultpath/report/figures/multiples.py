"""The effects of several audits on one path: small panels that share an axis."""

from collections.abc import Sequence

from faultpath.record import wording
from faultpath.report.figures.effects import EffectRow, directions, extent, mark
from faultpath.report.scale import Axis, covering, draw_uprights
from faultpath.report.svg import Svg, shortened, text_width

_WIDTH, _TOP, _PITCH = 350.0, 44.0, 48.0

Rows = Sequence[tuple[str, EffectRow | str]]
"""The label of each run, with its effect on a path, or why it has none."""


def shared_axis(panels: Sequence[Rows]) -> Axis:
    """Return the axis that all panels have in common, percentage points."""
    present = [row for rows in panels for _, row in rows if isinstance(row, EffectRow)]
    return covering(extent(present), least=10.0)


def multiple(title: str, rows: Rows, axis: Axis) -> str:
    """Return the panel of one path: success of the repair minus that of the baseline, a row a run.

    Dots, whiskers and shading are those of the forest plot.
    """
    told = "; ".join(f"{label}: {_value(row)}" for label, row in rows)
    bottom = _TOP + _PITCH * len(rows)
    name = f"{title}: success of the repair minus success of the baseline, percentage points"
    svg = Svg(_WIDTH, bottom + 40, name, told)
    svg.text(0, 14, shortened(title, _WIDTH, 13), "head", tip=title)
    plot = axis.at(8, _WIDTH - 8)
    directions(svg, plot, 33)
    draw_uprights(svg, plot, _TOP - 4, bottom, 6)
    svg.text(_WIDTH / 2, bottom + 34, "repair minus baseline, pp", "small soft", "middle")
    for index, (label, row) in enumerate(rows):
        _row(svg, plot, _TOP + _PITCH * index, label, row)
    return svg.render()


def _value(row: EffectRow | str) -> str:
    return row if isinstance(row, str) else wording.with_interval(row.effect)


def _row(svg: Svg, plot: Axis, y: float, label: str, row: EffectRow | str) -> None:
    """Draw a run: label, what keeps its effect out of a headline, numbers, and the interval."""
    value = _value(row)
    note, sign = ("", 0) if isinstance(row, str) else (row.note, row.sign)
    room = _WIDTH - text_width(value, 12) - text_width(note, 11) - 18
    name = shortened(label, room, 12)
    svg.rect(0, y + 3, _WIDTH, 18, "paper")
    svg.text(0, y + 16, name, tip=label)
    if note:
        svg.text(text_width(name, 12) + 6, y + 16, note, "small soft")
    svg.text(_WIDTH, y + 16, value, "bold" if sign else "", "end")
    if not isinstance(row, str):
        mark(svg, plot, row.effect, y + 34, row.sign, row.band_pp)
