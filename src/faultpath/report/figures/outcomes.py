"""How the trials of each cell ended."""

from collections.abc import Mapping, Sequence

from faultpath.record import wording
from faultpath.record.model import Cell
from faultpath.report.svg import Svg, shortened, text_width

_WIDTH = 390.0
_STATUSES = ("success", "crash", "timeout", "failed")


def outcome_bars(title: str, cells: Sequence[Cell], names: Mapping[str, str]) -> str:
    """Return one stacked bar for each cell of a path, counts written on the pieces.

    `names` says what the system calls its ends, where that is not the status itself.

    Success is plain and dark, crashes are hatched, timeouts plain and light, failed trials red.
    """
    said = {status: names.get(status, status) for status in _STATUSES}
    told = "; ".join(
        f"{c.variant}: " + ", ".join(f"{getattr(c, s)} {word}" for s, word in said.items())
        for c in cells
    )
    svg = Svg(_WIDTH, 18 + 50 * len(cells), f"{title}: how the trials ended", told)
    hatch = svg.hatch("crash", "crash-line")
    svg.text(0, 14, shortened(title, _WIDTH, 13), "head", tip=title)
    for i, cell in enumerate(cells):
        y = 38.0 + 50 * i
        svg.text(0, y, shortened(cell.variant, _WIDTH - 250, 12), tip=cell.variant)
        svg.text(_WIDTH, y, _beside(cell), "small soft", "end")
        _bar(svg, cell, y + 6, hatch, names)
    return svg.render()


def _beside(cell: Cell) -> str:
    failed = f"{cell.failed} failed · " if cell.failed else ""
    if cell.median_time_s is None:
        return f"{failed}no success"
    return f"{failed}median time of successes {wording.plain(cell.median_time_s, 2)} s"


def _bar(svg: Svg, cell: Cell, y: float, hatch: str, names: Mapping[str, str]) -> None:
    x, scale = 0.0, _WIDTH / max(cell.trials, 1)
    for status in _STATUSES:
        n: int = getattr(cell, status)
        width = n * scale
        if not n:
            continue
        svg.rect(
            x,
            y,
            max(width - 1.5, 2),
            20,
            status,
            1.5,
            tip=f"{wording.counted(n, 'trial')}: {names.get(status, status)}",
        )
        if status == "crash":
            svg.filled(x, y, width - 1.5, 20, hatch)
        _count(svg, f"{n} {names.get(status, status)}", str(n), x, width, y, status)
        x += width


def _count(svg: Svg, full: str, brief: str, x: float, width: float, y: float, status: str) -> None:
    for label in (full, brief):
        room = text_width(label, 11) + 8
        if room <= width - 2:
            if status == "crash":
                svg.rect(x + 3, y + 3, room - 4, 14, "plate", 2)
            ink = f"on-{status}" if status in ("success", "failed") else ""
            svg.text(x + 5, y + 14, label, f"small {ink}".rstrip())
            return
