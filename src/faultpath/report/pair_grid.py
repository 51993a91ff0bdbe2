"""Grid of all pairs of a condition, a picture of each, and its key."""

from collections.abc import Collection, Mapping, Sequence
from itertools import groupby
from urllib.parse import quote

from markupsafe import Markup

from faultpath.analyses.pairs import Pair, PairKind
from faultpath.report.svg import Point, Svg, text_width

_WIDTH, _SIDE, _GAP, _MOST_COLUMNS = 390.0, 15.0, 2.0, 25
_LEAST, _LARGEST = 11.0, 19.0
"""Sides of a cell: its sign fits into the least."""
_ALWAYS = (PairKind.BOTH, PairKind.REPAIR_ONLY, PairKind.BASELINE_ONLY, PairKind.NEITHER)

_WORDS = {
    PairKind.BOTH: "both succeed",
    PairKind.REPAIR_ONLY: "only the repair succeeds",
    PairKind.BASELINE_ONLY: "only the baseline succeeds",
    PairKind.NEITHER: "neither succeeds",
    PairKind.VOID: "void: a trial failed to run, or the two are not the same trial",
}


def pair_grid(
    title: str,
    pairs: Sequence[Pair],
    counts: Mapping[PairKind, int],
    names: Mapping[str, str],
    shown: Collection[tuple[str, int]] = (),
) -> Markup:
    """Return the grid of one condition: a block for each topology, a column for each scene.

    `counts` are of all pairs; without `pairs` they stand alone.

    With several seeds a scene is a stack of cells, one a seed. `names` says what the system calls
    its ends. A cell whose scene and seed are among `shown` is a link to them in the viewer.
    """
    parts = [f"{_short(k)} {n}" for k, n in counts.items() if n or k in _ALWAYS]
    summary = ", ".join(parts)
    texts = [summary]
    if text_width(summary, 11) > _WIDTH:
        texts = [", ".join(parts[:2]) + ",", ", ".join(parts[2:])]
    ordered = sorted(pairs, key=lambda p: (p.topology, p.index, p.scene, p.seed))
    blocks = [
        (name, [list(stack) for _, stack in groupby(block, key=lambda p: (p.index, p.scene))])
        for name, block in groupby(ordered, key=lambda p: p.topology)
    ]
    n_seeds = max((len(stack) for _, stacks in blocks for stack in stacks), default=1)
    left = min(110.0, max((text_width(name, 12) + 10 for name, _ in blocks if name), default=0.0))
    longest = max((len(stacks) for _, stacks in blocks), default=1)
    columns = min(_MOST_COLUMNS, longest, int((_WIDTH - left) / (_LEAST + _GAP)))
    side = min(_LARGEST, (_WIDTH - left) / columns - _GAP)
    row_height = n_seeds * (side + 1) + (7 if n_seeds > 1 else 4)
    rows = sum(-(-len(stacks) // columns) for _, stacks in blocks)
    y = 27.0 + 15 * len(texts)
    height = y + rows * row_height + 4 * (len(blocks) - 1)
    svg = Svg(_WIDTH, height, f"{title}: pairs", summary, "group")
    svg.text(0, 14, title, "head", room=_WIDTH)
    for place, text in enumerate(texts):
        svg.text(0, 31 + 15 * place, text, "small soft")
    for name, stacks in blocks:
        svg.text(0, y + side / 2 + 4, name, "soft", room=left - 8)
        for k, stack in enumerate(stacks):
            x = left + (k % columns) * (side + _GAP)
            at = y + (k // columns) * row_height
            for j, pair in enumerate(stack):
                link = address(pair) if (pair.scene, pair.seed) in shown else ""
                _cell(svg, pair, (x, at + j * (side + 1)), side, names, link)
        y += -(-len(stacks) // columns) * row_height + 4
    return svg.render()


def pair_key(pairs: Sequence[Pair]) -> list[tuple[Markup, str]]:
    """Return the key of the grids: a small picture and its word, for each kind that occurs."""
    entries: list[tuple[Markup, str]] = []
    for kind in (k for k in PairKind if k in _ALWAYS or any(p.kind is k for p in pairs)):
        svg = Svg(_SIDE, _SIDE, _WORDS[kind])
        _sign(svg, kind, 0.5, 0.5, _SIDE - 1)
        entries.append((svg.render(), _short(kind)))
    return entries


def _short(kind: PairKind) -> str:
    return kind.value.replace("-", " ")


def address(pair: Pair) -> str:
    """Return the part of a page's address that shows a pair in the viewer."""
    scene, condition = (quote(text, safe="") for text in (pair.scene, pair.condition))
    return f"#scene={scene}&seed={pair.seed}&condition={condition}"


def _cell(
    svg: Svg, pair: Pair, at: Point, side: float, names: Mapping[str, str], link: str
) -> None:
    ends = ", ".join(
        f"{variant} {names.get(trial.status, trial.status) if trial else 'did not run'}"
        for variant, trial in (("baseline", pair.baseline), ("repair", pair.repair))
    )
    tip = f"{pair.scene}, seed {pair.seed}: {pair.void_reason or ends}"
    # By key, scenes are chosen from the viewer's list.
    tab = {"tabindex": "-1"} if link else {}
    with svg.group("pair", tip, link, data_scene=pair.scene, **tab):
        _sign(svg, pair.kind, *at, side)


def _sign(svg: Svg, kind: PairKind, left: float, top: float, side: float) -> None:
    """Draw a cell with its sign."""
    svg.rect(left, top, side, side, "void-cell" if kind is PairKind.VOID else "cell", 2)
    x, y = left + side / 2, top + side / 2
    match kind:
        case PairKind.BOTH:
            svg.circle((x, y), 3.4, "both")
        case PairKind.REPAIR_ONLY:
            svg.polygon([(x - 5.5, y + 4.5), (x + 5.5, y + 4.5), (x, y - 5.5)], "repair-only")
        case PairKind.BASELINE_ONLY:
            svg.polygon([(x - 5.5, y - 4.5), (x + 5.5, y - 4.5), (x, y + 5.5)], "baseline-only")
        case PairKind.NEITHER:
            svg.circle((x, y), 2.2, "neither")
        case PairKind.VOID:
            svg.path(f"M{x - 4} {y - 4}L{x + 4} {y + 4}M{x - 4} {y + 4}L{x + 4} {y - 4}", "void")
