"""The outcome table as pairs, both arms in the same scene, path and seed, read and drawn."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import groupby
from urllib.parse import quote

from faultpath.decisions.model import DecisionRecord
from faultpath.report.svg import Point, Svg, text_width
from faultpath.trials import Outcome, OutcomeTable, Status, TrialRow


class Kind(StrEnum):
    """Kind of a pair: how its two trials ended."""

    BOTH = "both"
    REPAIR_ONLY = "repair-only"
    BASELINE_ONLY = "baseline-only"
    NEITHER = "neither"
    LEFT_OUT = "left-out"
    VOID = "void"

    @property
    def short(self) -> str:
        """In two words."""
        return self.value.replace("-", " ")


WORDS = {
    Kind.BOTH: "both succeed",
    Kind.REPAIR_ONLY: "only the repair succeeds",
    Kind.BASELINE_ONLY: "only the baseline succeeds",
    Kind.NEITHER: "neither succeeds",
    Kind.LEFT_OUT: "left out: a pair of this scene is void on another path or seed",
    Kind.VOID: "void: a trial failed to run, or the two are not the same trial",
}


@dataclass(frozen=True)
class Pair:
    """Both arms in one scene on one path with one seed; an arm is `None` when it never ran."""

    path: str
    seed: int
    scene: str
    index: int
    topology: str
    baseline: Outcome | None
    repair: Outcome | None
    left_out: bool = False
    """Another pair of the scene is void, so no effect counts the scene."""

    @property
    def void_reason(self) -> str | None:
        """Why the pair says nothing, or `None` for a pair that counts."""
        for arm, trial in (("baseline", self.baseline), ("repair", self.repair)):
            if trial is None:
                return f"the {arm} did not run"
            if trial.failed:
                return f"the {arm} failed: {trial.error or 'no message was kept'}"
        if self.baseline and self.repair and _met(self.baseline) != _met(self.repair):
            return "the two arms differ in initial state, disturbance or planner noise"
        return None

    @property
    def kind(self) -> Kind:
        """Kind of the pair."""
        if self.void_reason is not None or self.baseline is None or self.repair is None:
            return Kind.VOID
        if self.left_out:
            return Kind.LEFT_OUT
        one, two = (t.status is Status.SUCCESS for t in (self.baseline, self.repair))
        if one is two:
            return Kind.BOTH if one else Kind.NEITHER
        return Kind.REPAIR_ONLY if two else Kind.BASELINE_ONLY

    @property
    def sign(self) -> int:
        """+1 where only the repair succeeds, -1 where only the baseline does, else 0."""
        return {Kind.REPAIR_ONLY: 1, Kind.BASELINE_ONLY: -1}.get(self.kind, 0)


def read_pairs(outcomes: OutcomeTable, record: DecisionRecord) -> tuple[Pair, ...]:
    """Return every pair of the record's arms, ordered by path, topology, scene index and seed."""
    question, compared = record.question, {effect.path for effect in record.effects}
    named = [path.name for path in record.paths]
    trials: dict[tuple[str, str, int, str], Outcome] = {}
    places: dict[tuple[str, int, str], TrialRow] = {}
    for row in outcomes.rows:
        if row.variant in (question.baseline, question.repair) and row.path in named:
            place = (row.path, row.seed, row.outcome.scene)
            trials[row.variant, *place] = row.outcome
            places.setdefault(place, row)
    paths = list(dict.fromkeys(path for path, _, _ in places))
    pairs = [
        Pair(
            path=row.path,
            seed=row.seed,
            scene=row.outcome.scene,
            index=row.scene_index,
            topology=row.topology,
            baseline=trials.get((question.baseline, *place)),
            repair=trials.get((question.repair, *place)),
        )
        for place, row in places.items()
    ]
    void = {p.scene for p in pairs if p.kind is Kind.VOID and p.path in compared}
    pairs = [replace(pair, left_out=pair.scene in void) for pair in pairs]
    return tuple(sorted(pairs, key=lambda p: (paths.index(p.path), p.topology, p.index, p.seed)))


def by_scene(pairs: Iterable[Pair]) -> dict[tuple[str, int], dict[str, Pair]]:
    """Return the pairs by scene and seed, in each by path."""
    groups: dict[tuple[str, int], dict[str, Pair]] = {}
    for pair in pairs:
        groups.setdefault((pair.scene, pair.seed), {})[pair.path] = pair
    return groups


def _met(outcome: Outcome) -> tuple[str, str, str]:
    return outcome.initial_hash, outcome.disturbance_hash, outcome.planner_noise_hash


_WIDTH, _SIDE, _GAP, _MOST_COLUMNS = 390.0, 15.0, 2.0, 25
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
    summary = ", ".join(f"{k.short} {n}" for k, n in counts.items() if n or k in _ALWAYS)
    ordered = sorted(pairs, key=lambda p: (p.topology, p.index, p.scene, p.seed))
    blocks = [
        (name, [list(stack) for _, stack in groupby(block, key=lambda p: (p.index, p.scene))])
        for name, block in groupby(ordered, key=lambda p: p.topology)
    ]
    n_seeds = max((len(stack) for _, stacks in blocks for stack in stacks), default=1)
    left = min(110.0, max((text_width(name, 12) + 10 for name, _ in blocks if name), default=0.0))
    columns = min(_MOST_COLUMNS, max((len(stacks) for _, stacks in blocks), default=1))
    side = max(11.0, min(19.0, (_WIDTH - left) / columns - _GAP))
    row_height = n_seeds * (side + 1) + (7 if n_seeds > 1 else 4)
    rows = sum(-(-len(stacks) // columns) for _, stacks in blocks)
    svg = Svg(
        _WIDTH, 42 + rows * row_height + 4 * (len(blocks) - 1), f"{title}: pairs", summary, "group"
    )
    svg.text(0, 14, title, "head", room=_WIDTH)
    svg.text(0, 31, summary, "small soft")
    y = 42.0
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


def pair_key(pairs: Sequence[Pair]) -> list[tuple[str, str]]:
    """Return the key of the grids: a small picture and its word, for each kind that occurs."""
    entries: list[tuple[str, str]] = []
    for kind in (k for k in Kind if k in _ALWAYS or any(p.kind is k for p in pairs)):
        svg = Svg(_SIDE, _SIDE, WORDS[kind])
        svg.rect(0.5, 0.5, _SIDE - 1, _SIDE - 1, "void-cell" if kind is Kind.VOID else "cell", 2)
        _glyph(svg, kind, _SIDE / 2, _SIDE / 2)
        entries.append((svg.render(), kind.short))
    return entries


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
    # By key, scenes are chosen from the viewer's list.
    tab = {"tabindex": "-1"} if link else {}
    with svg.group("pair", tip, link, data_scene=pair.scene, **tab):
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
