"""Films of the documents: one scene with a fault at one module beside the same scene with it shared.

A film is an SVG that CSS moves, so it needs no script and plays in an `<img>`; its still is the
same picture without the motion, in the state in which the film ends. `film_quadrotor.py` and
`film_openpilot.py` draw what moves; what all films have in common is here.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from blocks import OUTCOMES, REFERENCE, Picture, Run, load

from faultpath.analyses.effects import Effect
from faultpath.analyses.model import SHARED
from faultpath.analyses.sentences import wording
from faultpath.api.replaying import outcomes_at
from faultpath.report.svg import Point, Svg, number
from faultpath.run.store.folder import read_outcomes
from faultpath.system.outcome import Outcome, Status

CARD, GAP, PAD, TOP = 412.0, 16.0, 14.0, 34.0
"""Width of a half, pixels between the halves and around what is in one, and where they begin."""
WIDTH = 2 * CARD + GAP
HEAD = 62.0
"""Height of the titles of a half."""
FOOT = 112.0
"""Height of the numbers below the scene."""
_ROW = 22.0
_LINE = 20.0
"""Height of a line of the clock."""
_FADE_S = 0.35
CSS = """
.fig text.title { font-size: 15px; font-weight: 600; }
.fig text.clock { font-size: 17px; font-weight: 600; }
.fig text.name { font-size: 13px; font-weight: 600; }
.fig .card { fill: var(--paper); stroke: var(--rule); }
.fig .chip { fill: var(--paper); stroke: var(--rule); }
.fig .chip.hit { fill: var(--faulted-wash); stroke: var(--faulted); }
.fig .trail { fill: none; stroke: var(--side); stroke-width: 3; stroke-linecap: round; stroke-linejoin: round; }
.fig .sign { fill: none; stroke: var(--side); stroke-width: 3; stroke-linecap: round; stroke-linejoin: round; }
.fig .sign.under { stroke: var(--paper); stroke-width: 7; }
.fig .ring { fill: none; stroke: var(--side); stroke-width: 2; }
.fig .track { fill: var(--faint); }
.fig .bar { fill: var(--side); }
"""
SIGNS = {Status.SUCCESS: "M-6 0.5l4 4.5 8 -10", Status.CRASH: "M-5 -5l10 10m0 -10l-10 10"}
_OTHER = "M-4.5 -4.5h9v9h-9z"

Frames = Sequence[tuple[float, str]]
"""Declarations of CSS by the second of the trial at which they hold; between two they blend."""


class Half(NamedTuple):
    """One side of a film: its condition, the titles, and each reader with whether it reads wrong
    values."""

    condition: str
    over: str
    title: str
    readers: Mapping[str, bool]


@dataclass(frozen=True)
class Story:
    """What a film shows: a scene of a run under two conditions, and the words for what a trial does and how it ends."""

    run: str
    scene: str
    seed: int
    halves: tuple[Half, Half]
    during: str
    ends: Mapping[Status, str]
    legend: Mapping[str, str]
    """What each variant is, the baseline first."""
    about: str
    """What the whole film shows, for who cannot see it."""

    @property
    def conditions(self) -> tuple[str, str]:
        return self.halves[0].condition, self.halves[1].condition


class Film(Svg):
    """A picture in which classes move; `slow` seconds of it are one second of the trial."""

    def __init__(
        self, story: Story, room: float, lasts_s: float, slow: float, hold_s: float, css: str
    ):
        super().__init__(WIDTH, TOP + HEAD + room + FOOT, story.about)
        self._css = CSS + css
        self.story, self.room, self.lasts_s, self.slow = story, room, lasts_s, slow
        self.loop_s = lasts_s * slow + hold_s
        self._motions: dict[str, str] = {}

    def moving(self, frames: Frames, always: str = "", timing: str = "linear") -> str:
        """Return a class that goes through the frames; `always` holds in the film alone."""
        ends = [(0.0, frames[0][1]), *frames]
        shares = [(100 * at * self.slow / self.loop_s, what) for at, what in ends]
        body = "".join(f"{share:.2f}%{{{what}}}" for share, what in [*shares, (100, ends[-1][1])])
        return self._motion(body, always, timing)

    def _motion(self, body: str, always: str, timing: str) -> str:
        motion = f"{{{always}animation:NAME {self.loop_s:g}s {timing} infinite}}@keyframes NAME{{{body}}}"
        return self._motions.setdefault(motion, f"m{len(self._motions)}")

    def from_second(self, at: float, shown: bool = True) -> str:
        """Return a class that shows something from a second on, or until then."""
        before, after = (f"opacity:{int(seen)}" for seen in (not shown, shown))
        return self.moving([(at, before), (at + 1e-3, after)])

    def fading(self) -> str:
        """Return a class that fades out where the film begins anew."""
        fade = 100 * _FADE_S / self.loop_s
        return self._motion(
            f"0%{{opacity:0}}{fade:.2f}%{{opacity:1}}{100 - fade:.2f}%{{opacity:1}}100%{{opacity:0}}",
            "",
            "linear",
        )

    def written(self, moves: bool) -> str:
        """Return the film, or its still."""
        motions = "".join(
            f".{name}{motion.replace('NAME', name)}\n" for motion, name in self._motions.items()
        )
        css = self._css + (motions if moves else "")
        return self.render(standalone=True).replace("</style>", f"{css}</style>", 1) + "\n"

    def trail(self, points: Sequence[Point], times: Sequence[float], variant: str) -> None:
        """Draw a line that grows with time."""
        lengths = [0.0]
        for a, b in zip(points, points[1:], strict=False):
            lengths.append(lengths[-1] + ((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) ** 0.5)
        whole = lengths[-1] or 1.0
        frames = [
            (at, f"stroke-dashoffset:{1000 - 1000 * length / whole:.0f}")
            for at, length in zip(times, lengths, strict=True)
        ]
        grows = self.moving(frames, "stroke-dasharray:1000;")
        d = "M" + "L".join(f"{number(x)} {number(y)}" for x, y in points)
        self.path(d, f"trail {variant} {grows}", pathLength="1000")

    def ending(self, at: Point, seconds: float, status: Status, variant: str) -> None:
        """Mark how and where a trial ends, from then on."""
        place = f"translate({number(at[0])},{number(at[1])})"
        with self.group(variant, transform=place):
            with self.group(self.from_second(seconds)):
                pops = [(seconds, "transform:scale(2)"), (seconds + 0.12, "transform:scale(1)")]
                with self.group(self.moving(pops)):
                    self.path(SIGNS.get(status, _OTHER), "sign under")
                    self.path(SIGNS.get(status, _OTHER), "sign")
            if status is Status.CRASH:
                spreads = [
                    (seconds, "transform:scale(.2);opacity:0"),
                    (seconds + 1e-3, "transform:scale(.2);opacity:1"),
                    (seconds + 0.45, "transform:scale(1);opacity:0"),
                ]
                with self.group(self.moving(spreads), opacity="0"):
                    self.circle((0, 0), 34, "ring")

    def clock(self, step_s: float) -> None:
        """Draw the time that has passed, at the right of the top."""
        count = round(self.lasts_s / step_s)
        window = self.clip("clock", (WIDTH - 70, 0), (WIDTH, 22), "")
        frames = [
            (0.0, f"transform:translateY(0px);animation-timing-function:steps({count})"),
            (self.lasts_s, f"transform:translateY({-_LINE * count:g}px)"),
        ]
        with (
            self.group("", clip_path=window),
            self.group(self.moving(frames), transform=f"translate(0,{number(-_LINE * count)})"),
        ):
            for step in range(count + 1):
                self.text(WIDTH, 16 + _LINE * step, f"{step * step_s:.2f} s", "clock", "end")
        pace = "real time" if self.slow == 1 else "half speed" if self.slow == 2 else ""
        self.text(WIDTH - 76, 16, pace, "soft", "end")

    def card(self, left: float, half: Half) -> None:
        """Draw the frame of a half, its titles, and who reads the wrong values."""
        self.rect(left, TOP, CARD, HEAD + self.room + FOOT, "card", 10)
        self.text(left + PAD, TOP + 24, half.over, "soft")
        self.text(left + PAD, TOP + 45, half.title, "title")
        right, source = left + CARD - PAD, (left + CARD - PAD - 120, TOP + 31.0)
        for place, (reader, wrong) in enumerate(half.readers.items()):
            hit, y = " hit" if wrong else "", TOP + 20.0 + 22 * place
            self.path(
                f"M{number(source[0])} {number(source[1])}C{number(source[0] + 15)} {number(source[1])} "
                f"{number(source[0] + 9)} {number(y)} {number(right - 96)} {number(y)}",
                f"wire{hit}",
            )
            self.rect(right - 96, y - 9.5, 96, 19, f"chip{hit}", 5)
            self.text(right - 48, y + 4, reader, "small faulted" if wrong else "small soft", "middle")
        self.circle(source, 5, "source wrong")

    def numbers(self, left: float, half: Half, trials: Mapping[str, Outcome], run: Run) -> None:
        """Write how each trial of a half ends, and how often each variant succeeds in all scenes."""
        effect = effect_of(run, half.condition)
        y = TOP + HEAD + self.room + 24
        bars, right = left + 246.0, left + CARD - PAD
        words = left + 104
        self.text(words, y, "in this scene", "small soft")
        self.text(bars, y, f"success in all {run.record.scenes} scenes", "small soft")
        variants = (run.record.question.baseline, run.record.question.repair)
        for side, variant, rate in zip(("baseline", "repair"), variants, effect.rates, strict=True):
            y += _ROW
            trial = trials[variant]
            self.circle((left + PAD + 5, y - 4.5), 5, f"dot {side}")
            self.text(left + PAD + 16, y, variant, f"name {side}")
            said = f"{self.story.ends[trial.status]}, {trial.time_s:.2f} s"
            with self.group(f"{side} {self.from_second(trial.time_s)}"):
                sign = f"translate({number(words + 5)},{number(y - 5)}) scale(.75)"
                self.path(SIGNS.get(trial.status, _OTHER), "sign", transform=sign)
                self.text(words + 16, y, said)
            with self.group(self.from_second(trial.time_s, shown=False), opacity="0"):
                self.text(words + 16, y, self.story.during, "soft")
            wide = right - 52 - bars
            self.rect(bars, y - 10, wide, 11, "track", 3)
            with self.group(side):
                self.rect(bars, y - 10, wide * rate / 100, 11, "bar", 3)
            self.text(right, y, f"{rate:.1f} %", "", "end")
        self.text(left + CARD - PAD, y + 26, conclusion(run, effect), "name" if effect.sign else "", "end")

    def legend(self) -> None:
        """Say what the two colours are."""
        x = 0.0
        for side, (variant, what) in zip(("baseline", "repair"), self.story.legend.items(), strict=True):
            self.circle((x + 6, 11), 6, f"dot {side}")
            self.text(x + 18, 16, variant, f"name {side}")
            x += 18 + 8.2 * len(variant) + 8
            self.text(x, 16, what, "soft")
            x += 6.4 * len(what) + 26


def effect_of(run: Run, condition: str) -> Effect:
    """Return the effect of a run under a condition."""
    return next(effect for effect in run.record.effects if effect.condition == condition)


def conclusion(run: Run, effect: Effect) -> str:
    """Return what all scenes say of a condition, with the interval."""
    ends = ", ".join(wording.signed(end, 1) for end in effect.interval or ())
    if not effect.sign:
        return f"no significant difference: {wording.signed(effect.value, 1)} pp [{ends}]"
    size, ends = abs(effect.value), sorted(abs(end) for end in effect.interval or ())
    winner = run.record.winner(effect.sign)
    return f"{winner} ahead by {size:.1f} pp [{', '.join(f'{end:.1f}' for end in ends)}]"


def trials_of(story: Story) -> dict[str, dict[str, Outcome]]:
    """Return the trials of the film's scene, by condition and variant."""
    trials: dict[str, dict[str, Outcome]] = {condition: {} for condition in story.conditions}
    for at, outcome in all_trials(story.run).items():
        if (at.scene, at.seed) == (story.scene, story.seed) and at.condition in trials:
            trials[at.condition][at.variant] = outcome
    return trials


def all_trials(run: str):
    return outcomes_at(read_outcomes(REFERENCE / run / OUTCOMES))


def picture_of(drawing: Film, name: str) -> Picture:
    """Return a film with its still and its caption."""
    return Picture(f"{name}.svg", drawing.story.about, drawing.written(True), drawing.written(False))
