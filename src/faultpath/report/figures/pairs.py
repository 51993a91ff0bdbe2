"""Every scene as one cell: who succeeded there."""

from collections.abc import Collection, Mapping, Sequence
from itertools import groupby
from urllib.parse import quote

from faultpath.report.pairing import WORDS, Kind, Pair
from faultpath.report.svg import Point, Svg, shortened, text_width

_WIDTH, _SIDE, _GAP, _MOST_COLUMNS = 390.0, 15.0, 2.0, 25
_SHORT = {
    Kind.BOTH: "both",
    Kind.REPAIR_ONLY: "repair only",
    Kind.BASELINE_ONLY: "baseline only",
    Kind.NEITHER: "neither",
    Kind.LEFT_OUT: "left out",
    Kind.VOID: "void",
}
_ALWAYS = (Kind.BOTH, Kind.REPAIR_ONLY, Kind.BASELINE_ONLY, Kind.NEITHER)


def pair_grid(
    title: str,
    pairs: Sequence[Pair],
    names: Mapping[str, str],
    shown: Collection[tuple[str, int]] = (),
) -> str:
    """Return the grid of one path: a block for each topology, a column for each scene.

    With several seeds a scene is a stack of cells, one a seed. Triangles that point up are scenes
    that only the repair solved, pointing down only the baseline; a large disc is both, a small ring
    neither, a cross in a red box a void pair, a slash a scene left out because of one. `names` says
    what the system calls its ends. A cell whose scene and seed are among `shown` is a link to them
    in the viewer.
    """
    counts = {kind: sum(p.kind is kind for p in pairs) for kind in Kind}
    told = ", ".join(
        f"{_SHORT[k]} {n}" for k, n in counts.items() if n or k not in (Kind.VOID, Kind.LEFT_OUT)
    )
    blocks = _blocks(pairs)
    n_seeds = max((len(stack) for _, stacks in blocks for stack in stacks), default=1)
    left = min(110.0, max((text_width(name, 12) + 10 for name, _ in blocks if name), default=0.0))
    columns = min(_MOST_COLUMNS, max((len(stacks) for _, stacks in blocks), default=1))
    side = max(11.0, min(19.0, (_WIDTH - left) / columns - _GAP))
    row_height = n_seeds * (side + 1) + (7 if n_seeds > 1 else 4)
    rows = sum(-(-len(stacks) // columns) for _, stacks in blocks)
    svg = Svg(
        _WIDTH, 42 + rows * row_height + 4 * (len(blocks) - 1), f"{title}: pairs", told, "group"
    )
    svg.text(0, 14, shortened(title, _WIDTH, 13), "head", tip=title)
    svg.text(0, 31, told, "small soft")
    y = 42.0
    for name, stacks in blocks:
        svg.text(0, y + side / 2 + 4, shortened(name, left - 8, 12), "soft", tip=name)
        for k, stack in enumerate(stacks):
            x = left + (k % columns) * (side + _GAP)
            at = y + (k // columns) * row_height
            for j, pair in enumerate(stack):
                link = address(pair) if (pair.scene, pair.seed) in shown else ""
                _cell(svg, pair, (x, at + j * (side + 1)), side, names, link)
        y += -(-len(stacks) // columns) * row_height + 4
    return svg.render()


def pair_key(pairs: Sequence[Pair]) -> list[tuple[str, str]]:
    """Return the key of the grids: a small picture and its word, for each kind that occurs."""
    kinds = [k for k in Kind if k in _ALWAYS or any(p.kind is k for p in pairs)]
    return [(_sign(kind), _SHORT[kind]) for kind in kinds]


def _sign(kind: Kind) -> str:
    svg = Svg(_SIDE, _SIDE, WORDS[kind])
    svg.rect(0.5, 0.5, _SIDE - 1, _SIDE - 1, "void-cell" if kind is Kind.VOID else "cell", 2)
    _glyph(svg, kind, _SIDE / 2, _SIDE / 2)
    return svg.render()


def _blocks(pairs: Sequence[Pair]) -> list[tuple[str, list[list[Pair]]]]:
    ordered = sorted(pairs, key=lambda p: (p.topology, p.index, p.scene, p.seed))
    return [
        (name, [list(stack) for _, stack in groupby(block, key=lambda p: (p.index, p.scene))])
        for name, block in groupby(ordered, key=lambda p: p.topology)
    ]


def address(pair: Pair) -> str:
    """Return the part of a page's address that shows a pair in the viewer."""
    return f"#scene={quote(pair.scene, safe='')}&seed={pair.seed}&path={quote(pair.path, safe='')}"


def _cell(
    svg: Svg, pair: Pair, at: Point, side: float, names: Mapping[str, str], link: str
) -> None:
    x, y = at
    ends = ", ".join(
        f"{arm} {names.get(trial.status, trial.status) if trial else 'did not run'}"
        for arm, trial in (("baseline", pair.baseline), ("repair", pair.repair))
    )
    note = f" ({WORDS[Kind.LEFT_OUT]})" if pair.kind is Kind.LEFT_OUT else ""
    tip = f"{pair.scene}, seed {pair.seed}: {pair.void_reason or ends}{note}"
    with svg.group("pair", tip, data_scene=pair.scene, link=link):
        svg.rect(x, y, side, side, "void-cell" if pair.kind is Kind.VOID else "cell", 2)
        _glyph(svg, pair.kind, x + side / 2, y + side / 2)


def _glyph(svg: Svg, kind: Kind, x: float, y: float) -> None:
    match kind:
        case Kind.BOTH:
            svg.circle((x, y), 3.4, "both")
        case Kind.REPAIR_ONLY:
            svg.polygon([(x - 5.5, y + 4.5), (x + 5.5, y + 4.5), (x, y - 5.5)], "repair-only")
        case Kind.BASELINE_ONLY:
            svg.polygon([(x - 5.5, y - 4.5), (x + 5.5, y - 4.5), (x, y + 5.5)], "baseline-only")
        case Kind.NEITHER:
            svg.circle((x, y), 2.2, "neither")
        case Kind.LEFT_OUT:
            svg.path(f"M{x - 3.5} {y + 3.5}l7 -7", "neither")
        case Kind.VOID:
            svg.path(f"M{x - 4} {y - 4}L{x + 4} {y + 4}M{x - 4} {y + 4}L{x + 4} {y - 4}", "void")
