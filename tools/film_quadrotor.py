"""The film of the quadrotor: two flights through two doors, from above, in the same wind."""

from math import atan2, degrees, hypot

import numpy as np
from blocks import REFERENCE, Picture, Wrong, load, parsed
from film import CARD, GAP, HEAD, PAD, TOP, Film, Half, Story, picture_of, trials_of
from film_flights import FLIGHTS, RUN, SHOWN, Flights

from faultpath.report.svg import Point, number
from faultpath.run import SystemShown
from faultpath.system import FloorPlan
from faultpath.system.outcome import Status

WIDE = CARD - 2 * PAD
SLOW, HOLD_S = 2.0, 1.7
ARROWS_M = 1.05
"""Distance between two arrows of the wind."""
CSS = """
.fig .floor { fill: var(--wash); }
.fig .wall { fill: var(--soft); opacity: .75; }
.fig .room { fill: none; stroke: var(--soft); stroke-width: 3; opacity: .75; }
.fig .beam { fill: none; stroke: var(--soft); stroke-dasharray: 3 3; }
.fig .wind { fill: none; stroke: var(--soft); stroke-width: 1.4; stroke-linecap: round; opacity: .5; }
.fig .goal { fill: var(--good); fill-opacity: .13; stroke: var(--good); stroke-width: 1.5; stroke-dasharray: 4 3; }
.fig .body { fill: var(--side); stroke: var(--paper); stroke-width: 1; }
.fig .rotor { fill: var(--paper); stroke: var(--side); stroke-width: 1.6; }
.fig .frame { stroke: var(--side); stroke-width: 2; }
"""


def story(flights: Flights) -> Story:
    """Return what the film shows."""
    alone, shared = SHOWN
    return Story(
        run=RUN,
        scene=flights.scene,
        seed=flights.seed,
        halves=(
            Half(alone, "Wrong mass and thrust at", "the wind estimator only", {"wind estimator": True, "predictor": False}),
            Half(shared, "The same wrong values at", "every module that reads them", {"wind estimator": True, "predictor": True}),
        ),
        during="flying",
        ends={Status.SUCCESS: "at the goal", Status.CRASH: "crashed", Status.TIMEOUT: "out of time"},
        legend={"gru": "the original wind estimator", "gru+dcc": "retrained with wrong mass and thrust"},
        about="",
    )


def film() -> Picture:
    """Return the film and its still."""
    flights: Flights = parsed(FLIGHTS, Flights, "make it with tools/film_flights.py")
    shown = story(flights)
    system = SystemShown.model_validate_json((REFERENCE / RUN / "system.json").read_bytes())
    plan = system.plans[flights.scene]
    trials = trials_of(shown)
    scale = WIDE / (plan.high[0] - plan.low[0])
    room = scale * (plan.high[1] - plan.low[1])
    lasts = max(trial.time_s for by_variant in trials.values() for trial in by_variant.values())
    drawing = Film(shown, room, lasts, SLOW, HOLD_S, CSS)
    for place, half in enumerate(shown.halves):
        left, top = place * (CARD + GAP), TOP + HEAD
        drawing.card(left, half)

        def at(x: float, y: float, left: float = left + PAD) -> Point:
            return left + scale * (x - plan.low[0]), top + scale * (plan.high[1] - y)

        _room(drawing, plan, at, scale)
        _wind(drawing, plan, at, flights, system.control_dt_s)
        with drawing.group(drawing.fading()):
            for side, variant in zip(("baseline", "repair"), shown.legend, strict=True):
                (flight,) = (f for f in flights.flights if (f.condition, f.variant) == (half.condition, variant))
                trial = trials[half.condition][variant]
                points = [at(x / 100, y / 100) for x, y in zip(flight.x_cm, flight.y_cm, strict=True)]
                times = [min(step * system.control_dt_s, trial.time_s) for step in range(len(points))]
                drawing.trail(points, times, side)
                _quadrotor(drawing, points, times, side)
                drawing.ending(points[-1], trial.time_s, trial.status, side)
        drawing.numbers(left, half, trials[half.condition], load(RUN))
    drawing.legend()
    drawing.clock(system.control_dt_s)
    return picture_of(drawing, "film-quadrotor")


def _room(drawing, plan, at, scale):
    low, high = at(plan.low[0], plan.high[1]), at(plan.high[0], plan.low[1])
    drawing.rect(*low, high[0] - low[0], high[1] - low[1], "floor")
    for prism in plan.prisms:
        whole = prism.bottom <= plan.low[2] and prism.top >= plan.high[2]
        drawing.polygon([at(*corner) for corner in prism.corners], "wall" if whole else "beam")
    for pillar in plan.pillars:
        whole = pillar.bottom <= plan.low[2] and pillar.top >= plan.high[2]
        drawing.circle(at(pillar.x, pillar.y), scale * pillar.radius, "wall" if whole else "beam")
    drawing.rect(*low, high[0] - low[0], high[1] - low[1], "room", 2)
    goal, start = at(*plan.goal[:2]), at(*plan.start[:2])
    drawing.circle(goal, scale * 0.5, "goal")
    drawing.text(goal[0], goal[1] + scale * 0.5 + 14, "goal", "small soft", "middle")
    drawing.circle(start, 4, "source")
    drawing.text(start[0], start[1] - 10, "start", "small soft", "middle")
    metre = low[0] + 10, high[1] - 10
    drawing.path(f"M{number(metre[0])} {number(metre[1] - 4)}v4h{number(scale)}v-4", "seed")
    drawing.text(metre[0] + scale / 2, metre[1] - 6, "1 m", "small soft", "middle")


def _wind(drawing, plan, at, flights, dt_s):
    speeds = [hypot(*wind) for wind in flights.wind_cm_s]
    angles = np.unwrap([-atan2(north, east) for east, north in flights.wind_cm_s])
    turning = drawing.moving(
        [
            (step * dt_s, f"transform:rotate({degrees(angle):.0f}deg) scale({speed / max(speeds):.2f})")
            for step, (angle, speed) in enumerate(zip(angles, speeds, strict=True))
        ]
    )
    (x0, y0), (x1, y1) = plan.low[:2], plan.high[:2]
    columns, rows = round((x1 - x0) / ARROWS_M), round((y1 - y0) / ARROWS_M)
    corner = at(x1, y0)
    drawing.text(corner[0] - 10, corner[1] - 10, f"wind, up to {max(speeds) / 100:.1f} m/s", "small soft", "end")
    last = f"rotate({degrees(angles[-1]):.0f}) scale({speeds[-1] / max(speeds):.2f})"
    for column in range(columns):
        for row in range(rows):
            x, y = at(x0 + (column + 0.5) * (x1 - x0) / columns, y0 + (row + 0.5) * (y1 - y0) / rows)
            with drawing.group(transform=f"translate({number(x)},{number(y)})"), drawing.group(turning, transform=last):
                drawing.path("M-13 0h26m-7 -4.5l7 4.5l-7 4.5", "wind")


def _quadrotor(drawing, points, times, side):
    flies = drawing.moving([(at, f"transform:translate({number(x)}px,{number(y)}px)") for at, (x, y) in zip(times, points, strict=True)])
    x, y = points[-1]
    with drawing.group(f"{side} {drawing.from_second(times[-1], shown=False)}", opacity="0"):
        with drawing.group(flies, transform=f"translate({number(x)},{number(y)})"):
            drawing.path("M-5.5 -5.5l11 11m0 -11l-11 11", "frame")
            for dx, dy in ((-6, -6), (6, -6), (-6, 6), (6, 6)):
                drawing.circle((dx, dy), 3.6, "rotor")
            drawing.circle((0, 0), 3.6, "body")
