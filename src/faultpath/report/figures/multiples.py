"""The effects of several audits on one path: small panels that share an axis."""

from collections.abc import Sequence

from faultpath.report import wording
from faultpath.report.figures.effects import EffectRow, directions, extent, mark
from faultpath.report.scale import Axis, covering, draw_uprights
from faultpath.report.svg import Svg, shortened, text_width

_WIDTH, _TOP, _PITCH = 350.0, 44.0, 48.0

Rows = Sequence[tuple[str, EffectRow | None]]
"""The label of each run, with its effect on a path; `None` where it has no such path."""


def shared_axis(panels: Sequence[Rows]) -> Axis:
    """Return the axis that all panels have in common, percentage points."""
    present = [effect for rows in panels for _, effect in rows if effect is not None]
    return covering(extent(present), least=10.0)


def multiple(title: str, rows: Rows, axis: Axis) -> str:
    """Return the panel of one path: success of the repair minus that of the baseline, a row a run.

    Dots, whiskers and shading are those of the forest plot.
    """
    told = "; ".join(
        f"{label}: {wording.with_interval(row.effect) if row else 'no such path'}"
        for label, row in rows
    )
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


def _row(svg: Svg, plot: Axis, y: float, label: str, row: EffectRow | None) -> None:
    value = wording.with_interval(row.effect) if row else "no such path"
    note = row.note if row else ""
    room = _WIDTH - text_width(value, 12) - text_width(note, 11) - 18
    name = shortened(label, room, 12)
    svg.rect(0, y + 3, _WIDTH, 18, "paper")
    svg.text(0, y + 16, name, tip=label)
    if note:
        svg.text(text_width(name, 12) + 6, y + 16, note, "small soft")
    svg.text(_WIDTH, y + 16, value, "" if row is None or not row.sign else "bold", "end")
    if row is not None:
        mark(svg, plot, row.effect, y + 34, row.sign, row.band_pp)
