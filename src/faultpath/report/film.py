"""A scene of a run as a moving picture: every path and both arms on one clock, from above."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from faultpath.errors import UserError
from faultpath.record import wording
from faultpath.report.inputs import ReportInput
from faultpath.report.pairing import Pair, by_scene, read_pairs
from faultpath.report.svg import wrapped
from faultpath.report.viewer_choice import Track, captions, choose, track_of
from faultpath.report.viewer_hits import hit
from faultpath.text import extra
from faultpath.trials import FloorPlan, Outcome, Status

_Pixels: TypeAlias = tuple[float, float]

_INK = {
    "paper": "#ffffff",
    "wash": "#f5f6f7",
    "ink": "#1c2024",
    "soft": "#59626b",
    "rule": "#d8dce0",
    "repair": "#1f5fa6",
    "baseline": "#a84c14",
    "struck": "#b3261e",
}
_TILE, _HEIGHT, _GAP, _TOP, _LABEL = 210, 122, 14, 58, 22
_SAID, _LINE = 12, 17
"""Size and pitch of the caption."""
_FINE = 2
"""Drawn so much larger and made smaller again, for smooth lines."""
_MOST_FRAMES = 120
_HOLD_S = 2.0
"""How long the last frame stands."""
_ARMS = ("baseline", "repair")


def film(
    held: ReportInput, scene: str, seed: int | None, paths: Sequence[str], speed: float, out: Path
) -> None:
    """Write a scene as `.gif`; `paths` by default all, `seed` the one with which the report shows
    the scene, else the first.

    Raises `UserError` for another ending, a seed that was not run, a system without positions, and
    where pillow is missing.
    """
    if out.suffix != ".gif":
        raise UserError(f"{out}: a film is a .gif file: name it so.")
    asked = held.record.question
    all_pairs = read_pairs(held.outcomes, held.record)
    first = [at[1] for at in choose(held.record, held.traces, all_pairs) if at[0] == scene]
    drawn = [*first, asked.seeds[0]][0] if seed is None else seed
    pairs = by_scene(all_pairs).get((scene, drawn))
    if pairs is None:
        raise UserError(f"scene '{scene}' was not flown with seed {drawn}: choose {asked.seeds}.")
    wanted = [p for p in held.record.paths if p.name in pairs and (not paths or p.name in paths)]
    tiles = [
        _Tile.of(held, pairs[path.name], path.title, column, row)
        for column, path in enumerate(wanted)
        for row in range(2)
    ]
    last = max(len(tile.track) for tile in tiles) - 1
    if last < 1:
        raise UserError(f"{asked.system} gives no positions, so there is nothing to film.")
    stride = -(-last // _MOST_FRAMES)
    pace = held.traces.dt_s * stride / speed
    steps = [*range(0, last, stride), last]
    said = captions(held.record, all_pairs).get((scene, drawn), "")
    _write(out, _Film(held, scene, said, tiles, len(wanted)).frames(steps), len(steps), pace)


@dataclass(frozen=True)
class _Tile:
    """One arm on one path, and where it stands in the picture."""

    title: str
    arm: str
    track: Track
    ended: str
    status: Status
    solid: int | None
    column: int
    row: int

    @classmethod
    def of(cls, held: ReportInput, pair: Pair, title: str, column: int, row: int) -> "_Tile":
        """Return the tile of the arm in a row."""
        asked = held.record.question
        trial: Outcome | None = (pair.baseline, pair.repair)[row]
        if trial is None:
            nothing = np.empty((0, 3), np.float32)
            return cls(title, _ARMS[row], nothing, "did not run", Status.FAILED, None, column, row)
        track = track_of(held.traces, (asked.baseline, asked.repair)[row], pair)
        plan, words, solid = held.plans.get(pair.scene), wording.ended(asked, trial.status), None
        if plan and trial.status is Status.CRASH and len(track):
            struck = hit(plan, track[-1])
            words += f", {struck.words}" if struck else ""
            solid = struck.solid if struck else None
        return cls(title, _ARMS[row], track, words, trial.status, solid, column, row)

    @property
    def corner(self) -> _Pixels:
        """Upper left corner below what stands above all tiles."""
        return _GAP + self.column * (_TILE + _GAP), self.row * (_HEIGHT + _LABEL)


class _Film:
    """Draws the frames; what stands still is drawn once."""

    def __init__(
        self, held: ReportInput, scene: str, said: str, tiles: Sequence[_Tile], columns: int
    ) -> None:
        try:
            from PIL import Image, ImageDraw, ImageFont
        except ModuleNotFoundError:
            raise UserError(f"a film needs pillow, not installed here: {extra('film')}.") from None
        self._draw: Any = ImageDraw.Draw
        self._font: Any = ImageFont.load_default
        self._tiles, self._dt_s, self._smaller = tiles, held.traces.dt_s, Image.Resampling.LANCZOS
        plan = held.plans.get(scene)
        tracks = [tile.track for tile in tiles if len(tile.track)]
        low = np.min([track.min(0) for track in tracks] + ([plan.low] if plan else []), axis=0)
        high = np.max([track.max(0) for track in tracks] + ([plan.high] if plan else []), axis=0)
        room = np.array((_TILE - 12, _HEIGHT - 12))
        self._scale = float(np.min(room / np.maximum(high - low, 1e-6)[:2]))
        self._middle = (low + high)[:2] / 2
        width = _GAP + columns * (_TILE + _GAP)
        caption = wrapped(said, width, _SAID, 3)
        self._top = _TOP + _LINE * len(caption)
        height = self._top + 2 * (_HEIGHT + _LABEL) + 6
        self.size = (width + width % 2, height + height % 2)
        self._still = Image.new("RGB", (self.size[0] * _FINE, self.size[1] * _FINE), _INK["paper"])
        pen = self._draw(self._still)
        asked = held.record.question
        self._text(
            pen, (_GAP, 8), f"{plan.title or scene if plan else scene}, {asked.fault}", "ink", 15
        )
        for number, line in enumerate(caption):
            self._text(pen, (_GAP, 30 + _LINE * number), line, "soft", _SAID)
        for tile in tiles:
            x, y = self._corner(tile)
            if not tile.row:
                self._text(pen, (x, y - 22), tile.title, "ink", 14)
            pen.rectangle([v * _FINE for v in (x, y, x + _TILE, y + _HEIGHT)], fill=_INK["wash"])
            if plan:
                self._scene(pen, tile, plan)

    def frames(self, steps: Sequence[int]) -> Iterator[Any]:
        """Yield a picture for each step."""
        for step in steps:
            picture = self._still.copy()
            pen = self._draw(picture)
            clock = f"{step * self._dt_s:.1f} s"
            self._text(pen, (self.size[0] - _GAP - 46, 8), clock, "soft", 15)
            for tile in self._tiles:
                self._flight(pen, tile, step)
            yield picture.resize(self.size, self._smaller)

    def _flight(self, pen: Any, tile: _Tile, step: int) -> None:
        colour = _INK[tile.arm]
        now = min(step, len(tile.track) - 1)
        if now >= 0:
            points = [self._at(tile, point) for point in tile.track[: now + 1]]
            pieces = (
                [points]
                if tile.arm == "repair"
                else [points[i : i + 3] for i in range(0, len(points), 4)]
            )
            for piece in pieces:
                if len(piece) > 1:
                    pen.line(piece, fill=colour, width=2 * _FINE, joint="curve")
            x, y = points[-1]
            r = 3.5 * _FINE
            pen.ellipse((x - r, y - r, x + r, y + r), fill=colour)
        over = now == len(tile.track) - 1
        x, y = self._corner(tile)
        words = f"{tile.arm}: {tile.ended}" if over else f"{tile.arm}"
        self._text(pen, (x, y + _HEIGHT + 2), words, tile.arm, 12)
        if over and tile.solid is None and tile.status is Status.CRASH and now >= 0:
            (x, y), r = self._at(tile, tile.track[-1]), 5 * _FINE
            for a, b in ((-r, r), (r, -r)):
                pen.line(((x - r, y + a), (x + r, y + b)), fill=_INK["struck"], width=2 * _FINE)

    def _scene(self, pen: Any, tile: _Tile, plan: FloorPlan) -> None:
        def fill(number: int) -> str:
            return _INK["struck" if number == tile.solid else "rule"]

        for number, prism in enumerate(plan.prisms):
            pen.polygon([self._at(tile, corner) for corner in prism.corners], fill=fill(number))
        for number, pillar in enumerate(plan.pillars, len(plan.prisms)):
            self._ring(pen, tile, (pillar.x, pillar.y), pillar.radius, fill=fill(number))
        if plan.low[1] < plan.high[1]:
            self._ring(pen, tile, plan.goal, 0.5, outline=_INK["ink"], width=_FINE)
        else:  # along a line the goal is a place on it
            (x, y), half = self._at(tile, plan.goal), 16 * _FINE
            pen.line(((x, y - half), (x, y + half)), fill=_INK["ink"], width=_FINE)
        self._ring(pen, tile, plan.start, 3 / self._scale, fill=_INK["ink"])

    def _ring(self, pen: Any, tile: _Tile, at: Sequence[float], radius: float, **look: Any) -> None:
        (x, y), r = self._at(tile, at), radius * self._scale * _FINE
        pen.ellipse((x - r, y - r, x + r, y + r), **look)

    def _corner(self, tile: _Tile) -> _Pixels:
        x, y = tile.corner
        return x, y + self._top

    def _at(self, tile: _Tile, point: Any) -> _Pixels:
        x, y = self._corner(tile)
        across, up = (np.asarray(point)[:2] - self._middle) * self._scale
        return (x + _TILE / 2 + across) * _FINE, (y + _HEIGHT / 2 - up) * _FINE

    def _text(self, pen: Any, at: _Pixels, words: str, ink: str, size: int) -> None:
        place = (at[0] * _FINE, at[1] * _FINE)
        pen.text(place, words, fill=_INK[ink], font=self._font(size * _FINE))


def _write(out: Path, frames: Iterator[Any], count: int, pace_s: float) -> None:
    try:
        first, *rest = _with_palette(frames)
        held = [max(20, round(1000 * pace_s))] * (count - 1) + [round(1000 * _HOLD_S)]
        first.save(out, save_all=True, append_images=rest, duration=held, loop=0, optimize=True)
    except OSError as error:
        raise UserError(f"cannot write {out} ({error.strerror or error}).") from error


def _with_palette(frames: Iterator[Any]) -> Iterator[Any]:
    from PIL import Image, ImageColor

    grounds = [np.array(ImageColor.getrgb(_INK[name])) for name in ("paper", "wash")]
    inks = [np.array(ImageColor.getrgb(ink)) for ink in _INK.values()]
    mixed = [a + (b - a) * k // 4 for a in grounds for b in inks for k in range(5)]
    colours = dict.fromkeys(tuple(map(int, each)) for each in mixed)
    palette = Image.new("P", (1, 1))
    palette.putpalette([value for colour in colours for value in colour])
    for frame in frames:
        yield frame.quantize(palette=palette, dither=0)
