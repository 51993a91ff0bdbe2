"""A picture that moves: an SVG that CSS animates, so that it plays in an `<img>`, without a script.

Its still is the same picture without the motion, as it is at one second of the trial.
"""

import re
from collections.abc import Sequence
from contextlib import AbstractContextManager
from itertools import pairwise

from faultpath.report.svg import Point, Svg, number
from faultpath.system import Status

Frames = Sequence[tuple[float, str]]
"""Declarations of CSS by the second of the trial at which they hold; between two they blend."""

SIGNS = {Status.SUCCESS: "M-6 0.5l4 4.5 8 -10", Status.CRASH: "M-5 -5l10 10m0 -10l-10 10"}
OTHER_SIGN = "M-4.5 -4.5h9v9h-9z"
_FADE_S = 0.35
_LINE = 20.0
"""Height of a line of the clock, in pixels."""
_AT_ONCE = "animation-timing-function:step-end"
"""Holds what a frame says until the next one."""


class Film(Svg):
    """A picture that plays a trial from its first second to `lasts_s`, over and over."""

    def __init__(self, width: float, height: float, title: str, css: str) -> None:
        super().__init__(width, height, title)
        self._css = css
        self._motions: dict[str, str] = {}

    def times(self, lasts_s: float, slow: float, hold_s: float, still_s: float) -> "Film":
        """Set how long the trial lasts, how many seconds show one of it, how long the last picture
        stays, and which second the still shows."""
        self.lasts_s, self.slow, self.still_s = lasts_s, slow, still_s
        self.loop_s = lasts_s * slow + hold_s
        return self

    def moving(self, frames: Frames, always: str = "") -> str:
        """Return a class that goes through the frames; `always` holds in the film alone."""
        shares = [(at * self.slow / self.loop_s, what) for at, what in frames]
        if shares[0][0] > 0.0:
            shares.insert(0, (0.0, frames[0][1]))
        return self._motion([*shares, (1.0, frames[-1][1])], always)

    def carried(self, frames: Frames, cls: str = "") -> AbstractContextManager[None]:
        """Put what is drawn inside into a group that transforms carry along."""
        still = [what for at, what in frames if at <= self.still_s][-1]
        moves = [(at, f"transform:{what}") for at, what in frames]
        plain = re.sub(r"(?<=\d)(px|deg)", "", still)
        return self.group(f"{cls} {self.moving(moves)}".strip(), transform=plain)

    def appearing(self, seconds: float) -> str:
        """Return a class that shows something from a second of the trial on."""
        return self.moving([(0.0, f"opacity:0;{_AT_ONCE}"), (seconds, "opacity:1")])

    def vanishing(self, seconds: float) -> str:
        """Return a class that shows something until a second of the trial."""
        return self.moving([(0.0, f"opacity:1;{_AT_ONCE}"), (seconds, "opacity:0")])

    def fading(self) -> str:
        """Return a class that hides where the film begins anew."""
        fade = _FADE_S / self.loop_s
        hidden, seen = "opacity:0", "opacity:1"
        return self._motion([(0.0, hidden), (fade, seen), (1.0 - fade, seen), (1.0, hidden)], "")

    def _motion(self, frames: Frames, always: str) -> str:
        """Return the class of a motion, given by shares of the film; equal ones are one class."""
        body = "".join(f"{100 * share:.2f}%{{{what}}}" for share, what in frames)
        return self._motions.setdefault(f"{always}|{body}", f"m{len(self._motions)}")

    def written(self, moves: bool) -> str:
        """Return the film, or its still."""
        css = self._css
        for motion, name in self._motions.items() if moves else ():
            always, _, body = motion.partition("|")
            plays = f"animation:{name} {self.loop_s:g}s linear infinite"
            css += f".{name}{{{always}{plays}}}@keyframes {name}{{{body}}}\n"
        return str(self.render(standalone=True)).replace("</style>", f"{css}</style>", 1) + "\n"

    def trail(self, points: Sequence[Point], times: Sequence[float], side: str) -> None:
        """Draw a line that grows with time."""
        lengths = [0.0]
        for (x0, y0), (x1, y1) in pairwise(points):
            lengths.append(lengths[-1] + ((x0 - x1) ** 2 + (y0 - y1) ** 2) ** 0.5)
        parts = [round(1000 * length / (lengths[-1] or 1.0)) for length in lengths]
        frames = [
            (at, f"stroke-dashoffset:{1000 - part}") for at, part in zip(times, parts, strict=True)
        ]
        grows = self.moving(frames, "stroke-dasharray:1000;")
        still = max(part for at, part in zip(times, parts, strict=True) if at <= self.still_s)
        d = "M" + "L".join(f"{number(x)} {number(y)}" for x, y in points)
        self.path(d, f"trail {side} {grows}", pathLength="1000", stroke_dasharray=f"{still} 1000")

    def ending(self, at: Point, seconds: float, status: Status, side: str) -> None:
        """Mark how and where a trial ends, from then on."""
        sign, seen = SIGNS.get(status, OTHER_SIGN), str(int(seconds <= self.still_s))
        pops = [(seconds, "transform:scale(2)"), (seconds + 0.12, "transform:scale(1)")]
        spreads = [
            (0.0, f"transform:scale(.2);opacity:0;{_AT_ONCE}"),
            (seconds, "transform:scale(.2);opacity:1"),
            (seconds + 0.45, "transform:scale(1);opacity:0"),
        ]
        with self.group(side, transform=f"translate({number(at[0])},{number(at[1])})"):
            with self.group(self.appearing(seconds), opacity=seen), self.group(self.moving(pops)):
                self.path(sign, "sign under")
                self.path(sign, "sign")
            if status is Status.CRASH:
                with self.group(self.moving(spreads), opacity="0"):
                    self.circle((0, 0), 34, "ring")

    def clock(self, step_s: float, right: float) -> None:
        """Draw the seconds of the trial that have passed, a line above the other in a window."""
        count = round(self.lasts_s / step_s)
        window = self.clip("clock", (right - 70, 0), (right, 22), "")
        runs = [
            (0.0, f"transform:translateY(0px);animation-timing-function:steps({count})"),
            (self.lasts_s, f"transform:translateY({-_LINE * count:g}px)"),
        ]
        still = f"translate(0,{number(-_LINE * round(self.still_s / step_s))})"
        with self.group(clip_path=window), self.group(self.moving(runs), transform=still):
            for step in range(count + 1):
                self.text(right, 16 + _LINE * step, f"{step * step_s:.2f} s", "clock", "end")
        pace = {1.0: "real time", 2.0: "half speed"}[self.slow]
        self.text(right - 76, 16, pace, "soft", "end")
