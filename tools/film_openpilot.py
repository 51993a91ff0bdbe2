"""The film of openpilot's Nissan: two cars in one bend, seen by a camera that drives along."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from blocks import REFERENCE, Picture
from film import Film, Frames
from film_halves import CARD, PAD, SIDES, Half, Pace, Story, picture, told
from numpy.typing import NDArray

from faultpath.report.svg import Point, number
from faultpath.run.store.signals import SIGNALS, decode_signals
from faultpath.system import Status

Values = NDArray[np.float64]
Signals = Mapping[tuple[str, str], Mapping[str, Values]]
"""By condition and variant, and by name: the first component at each control step."""

DT_S, EVERY = 0.01, 10
"""Control step of the example, and steps from one frame to the next."""
SCALE, WIDE, TALL, AHEAD = 9.5, CARD - 2 * PAD, 240.0, 0.76
"""Pixels per metre, size of the view, and which share of it lies ahead of the cars."""
STRIP = 46.0
"""Height of what shows the messages."""
LANE_M, KEPT_M, POSTS_M = 3.6, 0.5, 6.0
STORY = told("openpilot")
STILL_S = 3.1
"""Just after the car has left its lane, and in view."""


@dataclass(frozen=True)
class Road:
    """Middle of the lane at each step, in metres, and its heading."""

    x: Values
    y: Values
    heading: Values

    def beside(self, left_m: Values | float) -> Values:
        """Return pixels of points so far to the left, one a step, or as many as `left_m` has."""
        left = np.broadcast_to(left_m, len(self.x)) if np.isscalar(left_m) else np.asarray(left_m)
        x, y, heading = (part[: len(left)] for part in (self.x, self.y, self.heading))
        at = x - left * np.sin(heading), -y - left * np.cos(heading)
        return SCALE * np.stack(at, axis=1)

    def longer(self, before_m: float, after_m: float) -> "Road":
        """Return the road with a straight piece at each end."""
        pieces: list[tuple[Values, Values, Values]] = [(self.x, self.y, self.heading)]
        for end, along in ((0, np.arange(-before_m, 0.0)), (-1, np.arange(1.0, after_m))):
            heading = np.full(len(along), self.heading[end])
            x, y = self.x[end] + along * np.cos(heading), self.y[end] + along * np.sin(heading)
            pieces.insert(0 if end == 0 else 2, (x, y, heading))
        return Road(*(np.concatenate(parts) for parts in zip(*pieces, strict=True)))


@cache
def film() -> Picture:
    """Return the film and its still."""
    signals = signals_of(STORY)
    clean = signals["correct", next(iter(STORY.variants))]
    speed = smooth(clean["speed"], 51)
    road = road_of(clean, speed)

    def draw(film: Film, half: Half, left: float, top: float) -> None:
        film.rect(left, top, WIDE, TALL, "grass", 4)
        window = film.clip(f"view-{half.condition}", (left, top), (left + WIDE, top + TALL), "")
        eye = f"translate({number(left + WIDE / 2)},{number(top + AHEAD * TALL)})"
        with (
            film.group(clip_path=window),
            film.group(film.fading(), transform=eye),
            film.carried(camera(road)),
        ):
            draw_road(film, road.longer(30.0, 60.0))
            for side, (variant, trial) in zip(SIDES, STORY.trials(half).items(), strict=True):
                offset = signals[half.condition, variant]["offset"]
                end = draw_car(film, road, offset, speed, side)
                if trial.status is Status.CRASH:
                    film.ending(end, trial.time_s, trial.status, side)
        for line, words in enumerate((f"green: at most {KEPT_M:g} m", "from the middle")):
            film.text(left + WIDE - 8, top + 16 + 14 * line, words, "small soft", "end")
        draw_messages(film, half, signals, left, top + TALL)

    pace = Pace(slow=1.0, hold_s=1.2, tick_s=0.1, still_s=STILL_S)
    widths = {"asphalt": 2 * LANE_M * SCALE + 10, "dash": 3 * SCALE, "kept": 2 * KEPT_M * SCALE}
    sizes = {name: f"{width:g}" for name, width in widths.items()}
    return picture("openpilot", STORY, pace, TALL + STRIP, draw, **sizes)


def signals_of(story: Story) -> Signals:
    """Return the recorded signals of the film's scene."""
    return {
        (at.condition, at.variant): {
            signal.name: signal.values[:, 0].astype(np.float64) for signal in signals
        }
        for at, signals in decode_signals((REFERENCE / story.run / SIGNALS).read_bytes()).items()
        if (at.scene, at.seed) == (story.scene, story.seed)
    }


def smooth(values: Values, steps: int) -> Values:
    """Return the mean around each value, of an odd number of steps."""
    padded = np.pad(values, steps // 2, mode="edge")
    return np.convolve(padded, np.full(steps, 1 / steps), "valid")


def slope(offset: Values, speed: Values) -> Values:
    """Return the angle between a car's way and its lane."""
    return np.arcsin(smooth(np.gradient(offset, DT_S), 21) / speed[: len(offset)])


def road_of(drive: Mapping[str, Values], speed: Values) -> Road:
    """Return the road that a car drove, from its yaw rate and its way off the lane's middle; all
    cars of a scene drive equally fast."""
    heading = smooth(np.cumsum(drive["yaw"]) * DT_S - slope(drive["offset"], speed), 21)
    x, y = (np.cumsum(speed * along(heading)) * DT_S for along in (np.cos, np.sin))
    return Road(x, y, heading)


def camera(road: Road) -> Frames:
    """Return how the road runs below a camera that drives along."""
    points, turns = road.beside(0.0), np.degrees(road.heading) - 90
    return [
        (step * DT_S, f"rotate({turns[step]:.2f}deg) translate({-x:.1f}px,{-y:.1f}px)")
        for step, (x, y) in enumerate(points)
        if step % EVERY == 0
    ]


def draw_road(film: Film, road: Road) -> None:
    """Draw two lanes, the part of ours that a car has to keep to, and posts beside the road."""
    lines = {
        "asphalt": (LANE_M / 2,),
        "kept": (0.0,),
        "edge": (-LANE_M / 2, 1.5 * LANE_M),
        "middle": (LANE_M / 2,),
    }
    for name, lefts in lines.items():
        for left_m in lefts:
            points = (f"{x:.1f} {y:.1f}" for x, y in road.beside(left_m)[::6])
            film.path("M" + "L".join(points), name)
    driven = np.cumsum(np.hypot(np.diff(road.x, prepend=0), np.diff(road.y, prepend=0)))
    posts = np.searchsorted(driven, np.arange(driven[0], driven[-1], POSTS_M))
    for left_m in (-1.3 * LANE_M, 2.3 * LANE_M):
        for x, y in road.beside(left_m)[posts]:
            film.circle((x, y), 5, "post")


def draw_car(film: Film, road: Road, offset: Values, speed: Values, side: str) -> Point:
    """Draw a car and its trail, the baseline's a little wider: both may be at one place. Return
    where it ends."""
    count = len(offset)
    points = road.beside(offset)
    turns = -np.degrees(road.heading[:count] + slope(offset, speed))
    steps = sorted({*range(0, count, EVERY), count - 1})
    times = [step * DT_S for step in steps]
    film.trail([(points[step, 0], points[step, 1]) for step in steps], times, side)
    drives = [
        "translate({:.1f}px,{:.1f}px) rotate({:.1f}deg)".format(*points[step], turns[step])
        for step in steps
    ]
    rim = 1.5 if side == "baseline" else 0.0
    with film.carried(list(zip(times, drives, strict=True)), side):
        film.rect(-22 - rim, -9 - rim, 44 + 2 * rim, 18 + 2 * rim, "hull", 5)
        film.rect(4, -6.5, 6, 13, "glass", 2)
        film.rect(-15, -6, 4, 12, "glass", 2)
    return points[-1, 0], points[-1, 1]


def draw_messages(film: Film, half: Half, signals: Signals, left: float, top: float) -> None:
    """Draw which steering messages of each variant passed the firmware, as time goes on."""
    film.text(left, top + 19, "steering messages", "small soft")
    for place, side in enumerate(SIDES):
        film.rect(left + 130 + 14 * place, top + 10, 14, 9, f"passed {side}")
    film.text(left + 163, top + 19, "passed", "small soft")
    film.rect(left + 222, top + 10, 14, 9, "stopped")
    film.text(left + 241, top + 19, "blocked by the firmware", "small soft")
    pixels = WIDE * DT_S / STORY.longest_s
    for row, (side, variant) in enumerate(zip(SIDES, STORY.variants, strict=True)):
        signs = np.sign(signals[half.condition, variant]["sent"])
        edges = np.flatnonzero(np.diff(signs, prepend=9, append=9))
        for begin, end in pairwise(edges):
            if sign := signs[begin]:
                cls = f"passed {side}" if sign > 0 else "stopped"
                at = left + pixels * begin, top + 27 + 11 * row
                film.rect(*at, pixels * (end - begin), 8, cls)
    still = [
        (0.0, "translate(0px,0px)"),
        (STILL_S, f"translate({pixels * STILL_S / DT_S:.1f}px,0px)"),
    ]
    runs = [*still, (STORY.longest_s, f"translate({WIDE}px,0px)")]
    window = film.clip(
        f"strip-{half.condition}", (left - 1, top), (left + WIDE + 1, top + STRIP), ""
    )
    with film.group(clip_path=window), film.carried(runs):
        film.rect(left, top + 26, WIDE + 2, 22, "paper")
        for row in range(len(SIDES)):
            film.rect(left, top + 27 + 11 * row, WIDE, 8, "track")
        film.line((left, top + 24), (left, top + 48), "zero")
