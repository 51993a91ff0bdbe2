"""The film of the quadrotor: two flights through two doors, from above, in the same wind."""

from collections.abc import Callable, Sequence
from functools import cache
from itertools import product
from math import atan2, hypot

import numpy as np
from blocks import REFERENCE, Picture, Wrong, parsed
from faultpath_quadrotor.scenes.library import GOAL_RADIUS_M
from film import Film
from film_flights import FLIGHTS, RUN, Flights
from film_halves import CARD, PAD, SIDES, Half, Pace, Story, picture, told

from faultpath.report.svg import Point, number
from faultpath.run.shown import SystemShown
from faultpath.system import FloorPlan

WIDE = CARD - 2 * PAD
ARROWS_M = 1.05
"""Distance between two arrows of the wind."""
REMEDY = "make it with tools/film_flights.py"
At = Callable[[float, float], Point]
"""Pixels of a place in the room, in metres."""


@cache
def film() -> Picture:
    """Return the film and its still."""
    flights: Flights = parsed(FLIGHTS, Flights, REMEDY)
    shown = SystemShown.model_validate_json((REFERENCE / RUN / "system.json").read_bytes())
    plan, story = shown.plans[flights.scene], story_of(flights)
    scale = WIDE / (plan.high[0] - plan.low[0])

    def draw(film: Film, half: Half, left: float, top: float) -> None:
        def at(x: float, y: float) -> Point:
            return left + scale * (x - plan.low[0]), top + scale * (plan.high[1] - y)

        draw_room(film, plan, at, scale)
        draw_wind(film, plan, at, flights.wind_cm_s, shown.control_dt_s)
        with film.group(film.fading()):
            for side, (variant, trial) in zip(SIDES, story.trials(half).items(), strict=True):
                flight = flights.of(half.condition, variant)
                if len(flight.places_cm) != trial.steps(shown.control_dt_s) + 1:
                    raise Wrong(f"{FLIGHTS.name} is not of {RUN}: {REMEDY}")
                points = [at(x / 100, y / 100) for x, y in flight.places_cm]
                times = [min(i * shown.control_dt_s, trial.time_s) for i in range(len(points))]
                film.trail(points, times, side)
                draw_quadrotor(film, points, times, side)
                film.ending(points[-1], trial.time_s, trial.status, side)

    height = scale * (plan.high[1] - plan.low[1])
    pace = Pace(slow=2.0, hold_s=1.7, tick_s=shown.control_dt_s)
    return picture("quadrotor", story, pace, height, draw)


def story_of(flights: Flights) -> Story:
    """Return what the film shows."""
    return told("quadrotor", scene=flights.scene, seed=flights.seed)


def draw_room(film: Film, plan: FloorPlan, at: At, scale: float) -> None:
    """Draw walls and obstacles, dashed where one can fly below or above, start, goal and scale."""
    (left, top), (right, bottom) = at(plan.low[0], plan.high[1]), at(plan.high[0], plan.low[1])
    box = left, top, right - left, bottom - top
    film.rect(*box, "floor")
    for prism in plan.prisms:
        whole = prism.bottom <= plan.low[2] and prism.top >= plan.high[2]
        film.polygon([at(*corner) for corner in prism.corners], "wall" if whole else "beam")
    for pillar in plan.pillars:
        whole = pillar.bottom <= plan.low[2] and pillar.top >= plan.high[2]
        film.circle(at(pillar.x, pillar.y), scale * pillar.radius, "wall" if whole else "beam")
    film.rect(*box, "room", 2)
    goal, start = at(*plan.goal[:2]), at(*plan.start[:2])
    film.circle(goal, scale * GOAL_RADIUS_M, "goal")
    film.text(goal[0], goal[1] + scale * GOAL_RADIUS_M + 14, "goal", "small soft", "middle")
    film.circle(start, 4, "source")
    film.text(start[0], start[1] - 10, "start", "small soft", "middle")
    film.path(f"M{number(left + 10)} {number(bottom - 14)}v4h{number(scale)}v-4", "seed")
    film.text(left + 10 + scale / 2, bottom - 16, "1 m", "small soft", "middle")


def draw_wind(
    film: Film, plan: FloorPlan, at: At, wind_cm_s: Sequence[tuple[int, int]], dt_s: float
) -> None:
    """Draw arrows that turn and grow with the wind."""
    speeds = [hypot(*wind) for wind in wind_cm_s]
    angles = np.degrees(np.unwrap([-atan2(north, east) for east, north in wind_cm_s]))
    turns = [
        (step * dt_s, f"rotate({angle:.0f}deg) scale({speed / max(speeds):.2f})")
        for step, (angle, speed) in enumerate(zip(angles, speeds, strict=True))
    ]
    columns, rows = (
        np.arange(low, high, (high - low) / round((high - low) / ARROWS_M))
        for low, high in zip(plan.low[:2], plan.high[:2], strict=True)
    )
    for x, y in product(columns + np.diff(columns)[0] / 2, rows + np.diff(rows)[0] / 2):
        place = "translate({},{})".format(*map(number, at(x, y)))
        with film.group(transform=place), film.carried(turns):
            film.path("M-13 0h26m-7 -4.5l7 4.5l-7 4.5", "wind")
    right, bottom = at(plan.high[0], plan.low[1])
    words = f"wind, up to {max(speeds) / 100:.1f} m/s"
    film.text(right - 10, bottom - 10, words, "small soft", "end")


def draw_quadrotor(film: Film, points: Sequence[Point], times: Sequence[float], side: str) -> None:
    """Draw the vehicle until its flight ends."""
    moves = [
        (time, f"translate({number(x)}px,{number(y)}px)")
        for time, (x, y) in zip(times, points, strict=True)
    ]
    until = f"{side} {film.vanishing(times[-1])}"
    with film.group(until, opacity="0"), film.carried(moves):
        film.path("M-5.5 -5.5l11 11m0 -11l-11 11", "frame")
        for x, y in product((-6, 6), repeat=2):
            film.circle((x, y), 3.6, "rotor")
        film.circle((0, 0), 3.6, "body")
