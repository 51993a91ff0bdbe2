"""A recorded flight on a grid of control intervals."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from faultpath.plugin.system import UserError
from faultpath_quadrotor.flightlog.reading import (
    SPEED_UNITS,
    ColumnMap,
    Floats,
    LogColumn,
    read_series,
)
from faultpath_quadrotor.vehicle import CONTROL_DT_S

GRAVITY_MPS2 = 9.80665
"""Standard gravity; the simulated vehicles fly with the paper's 9.81."""
INTERVAL_S = CONTROL_DT_S
_GAP = 10.0
"""A pause longer than so many usual ones, and than two intervals, ends a stretch of the flight."""


@dataclass(frozen=True)
class Flight:
    """Stretches of flight without a gap, cut into control intervals.

    World and body have a z axis that points up.
    """

    stretch: Floats
    """Number of the stretch of each interval, `[N]`."""
    time_s: Floats
    """Beginning of each interval, `[N]`, s."""
    rotation: Rotation
    """Body to world in the middle of each interval, `[N]`."""
    acceleration_mps2: Floats
    """Mean over each interval, `[N, 3]`, world frame."""
    velocity_mps: Floats
    """Mean over each interval, `[N, 3]`, world frame."""
    thrust_n: Floats
    """Commanded collective thrust, mean over each interval, `[N]`."""
    mass_kg: float
    drag_kgps: tuple[float, float, float] | None
    newton_per_unit: float
    gaps: int


@np.errstate(all="ignore")  # what comes of it is judged
def read_flight(path: Path, columns: ColumnMap) -> Flight:
    """Return the flight in a log.

    Raises `UserError` as `read_series`, for a quaternion of another order or length, thrust that
    does not carry the weight, and a log without a stretch to use.
    """
    if columns.mass_kg is None:
        raise UserError("the mass of the vehicle is not given: add mass_kg to the map, or --mass")
    series = read_series(path, columns)
    grids, gaps = _grids(path, list(series.values()))
    begin = np.concatenate([grid[:-1] for grid in grids])
    end = np.concatenate([grid[1:] for grid in grids])
    attitude = _attitude(path, columns, [series[name] for name in columns.attitude.columns])
    speed = [series[name] for name in columns.velocity.columns]
    before, after = (_velocity(columns, speed, attitude, time_s) for time_s in (begin, end))
    command = series[columns.thrust.column]
    # A command holds until the next one: its integral is a straight line up to there.
    integral = np.concatenate([[0.0], np.cumsum(np.diff(command.time_s) * command.values[:-1])])
    done, more = (np.interp(time_s, command.time_s, integral) for time_s in (begin, end))
    flight = Flight(
        stretch=np.repeat(np.arange(float(len(grids))), [len(grid) - 1 for grid in grids]),
        time_s=begin,
        rotation=attitude(0.5 * (begin + end)),
        acceleration_mps2=(after - before) / INTERVAL_S,
        velocity_mps=0.5 * (before + after),
        thrust_n=(more - done) / INTERVAL_S,
        mass_kg=columns.mass_kg,
        drag_kgps=columns.drag_kgps,
        newton_per_unit=1.0,
        gaps=gaps,
    )
    factor = _newton_per_unit(path, columns, flight)
    flight = replace(flight, thrust_n=factor * flight.thrust_n, newton_per_unit=factor)
    _check_order(path, columns, flight)
    if columns.check_frame:
        _check_frame(path, columns.frame, flight)
    return flight


def _grids(path: Path, columns: Sequence[LogColumn]) -> tuple[list[Floats], int]:
    """Return the ends of the control intervals of each stretch, and how many pauses there are."""
    pauses: list[tuple[float, float]] = []
    for column in columns:
        steps = np.diff(column.time_s)
        long = steps > max(_GAP * float(np.median(steps)), 2 * INTERVAL_S)
        pauses += zip(column.time_s[:-1][long], column.time_s[1:][long], strict=True)
    end = min(float(column.time_s[-1]) for column in columns)
    starts, stops = [max(float(column.time_s[0]) for column in columns)], list[float]()
    for before, after in sorted(pauses):
        if before < starts[-1]:  # that is within another pause, or before the flight
            starts[-1] = max(starts[-1], after)
        elif before < end:
            stops.append(before)
            starts.append(after)
    stops.append(end)
    grids = [
        start + INTERVAL_S * np.arange(int((stop - start) / INTERVAL_S) + 1, dtype=np.float64)
        for start, stop in zip(starts, stops, strict=True)
        if stop - start >= 2.0
    ]
    if not grids:
        raise UserError(
            f"{path}: no two seconds of flight in which all columns have readings: look for gaps, "
            "and whether the columns are of one flight"
        )
    return grids, len(starts) - 1


def _velocity(
    columns: ColumnMap, speed: Sequence[LogColumn], attitude: Slerp, time_s: Floats
) -> Floats:
    """Return the velocity in the world, z up, at some times `[T, 3]`."""
    velocity = _on(time_s, speed) * SPEED_UNITS[columns.velocity.unit]
    if columns.frame == "NED":
        velocity *= np.array([1.0, -1.0, -1.0])
    if columns.velocity.axes == "world":
        return velocity
    # Rounding may put the grid's end just beyond the last reading.
    return attitude(np.clip(time_s, *attitude.times[[0, -1]])).apply(velocity)


def _on(time_s: Floats, columns: Sequence[LogColumn]) -> Floats:
    """Return columns interpolated at some times, `[T, columns]`."""
    return np.stack([np.interp(time_s, column.time_s, column.values) for column in columns], axis=1)


def _attitude(path: Path, columns: ColumnMap, components: Sequence[LogColumn]) -> Slerp:
    time_s = components[0].time_s
    quaternion = _on(time_s, components)
    off = np.abs(np.linalg.norm(quaternion, axis=1) - 1)
    if np.median(off) > 0.02 or off.max() > 0.5:
        worst = int(off.argmax())
        length = np.linalg.norm(quaternion[worst])
        raise UserError(
            f"{path}: the attitude has the length {length:.3g} at its reading {worst}, and a unit "
            "quaternion has 1: correct its columns, or leave such cells empty"
        )
    if columns.attitude.order == "wxyz":
        quaternion = quaternion[:, [1, 2, 3, 0]]
    if columns.frame == "NED":  # half turns about x on both sides: z is up in world and body
        quaternion = quaternion * np.array([1.0, -1.0, -1.0, 1.0])
    return Slerp(time_s, Rotation.from_quat(quaternion))


def _newton_per_unit(path: Path, columns: ColumnMap, flight: Flight) -> float:
    """Return the thrust of one unit of the command, N."""
    factor = columns.thrust.newton_per_unit
    if factor == "fit":
        needed = flight.acceleration_mps2 + np.array([0.0, 0.0, GRAVITY_MPS2])
        axis = flight.rotation.apply([0.0, 0.0, 1.0])
        explaining = flight.mass_kg * (needed * axis).sum(1)
        power = float((flight.thrust_n**2).sum())
        factor = float((flight.thrust_n * explaining).sum()) / power if power else 0.0
    carried = float(np.median(factor * flight.thrust_n)) / (flight.mass_kg * GRAVITY_MPS2)
    if not 0.5 <= carried <= 2.0:
        raise UserError(
            f"{path}: the median thrust is {carried:.3g} times the weight: correct mass_kg, or "
            "newton_per_unit of the thrust (a factor, or fit)"
        )
    return factor


def _check_order(path: Path, columns: ColumnMap, flight: Flight) -> None:
    """Refuse an attitude that would explain the motion far better in the other order."""
    flip = np.array([1.0, -1.0, -1.0, 1.0]) if columns.frame == "NED" else np.ones(4)
    order, turned = "wxyz", [1, 2, 3, 0]
    if columns.attitude.order == "wxyz":
        order, turned = "xyzw", [3, 0, 1, 2]
    other = (flight.rotation.as_quat() * flip)[:, turned]
    swapped = replace(flight, rotation=Rotation.from_quat(other * flip))
    here, there = (
        float(np.median(np.linalg.norm(nominal(f) - f.acceleration_mps2, axis=1)))
        for f in (flight, swapped)
    )
    if there < 0.5 * here:
        raise UserError(
            f"{path}: thrust and weight explain the motion to {here:.3g} m/s^2 with the "
            f"quaternion's order {columns.attitude.order}, and to {there:.3g} m/s^2 with {order}: "
            "correct the order of the attitude"
        )


def _check_frame(path: Path, frame: str, flight: Flight) -> None:
    """Refuse motion that runs against thrust and weight: in the other frame both change sign.

    What changes within tenths of a second tells it: wind, and what a vehicle does about it, leave
    that correlation at 0 or above. Where noise hides it nothing is refused.
    """
    few = 4  # intervals together; alone, each is mostly noise of the log
    n = len(flight.stretch) // few * few
    stretch = flight.stretch[:n].reshape(-1, few)
    same = stretch[1:, -1] == stretch[:-1, 0]
    explained, seen = (
        np.diff(acceleration[:n].reshape(-1, few, 3).mean(axis=1), axis=0)[same]
        for acceleration in (nominal(flight), flight.acceleration_mps2)
    )
    size = float(np.sqrt((explained**2).sum() * (seen**2).sum()))
    against = -float((explained * seen).sum()) / size if size else 0.0
    if against > max(0.2, 4.0 / np.sqrt(same.sum())):
        other = "ENU" if frame == "NED" else "NED"
        raise UserError(
            f"{path}: with the frame {frame} the vehicle accelerates against thrust and weight "
            f"(correlation {-against:.2f}): write frame: {other}, or check_frame: false where "
            f"{frame} is right all the same"
        )


def nominal(flight: Flight, error: float = 0.0) -> Floats:
    """Return the acceleration a_0 that thrust, gravity and drag explain, `[N, 3]`, m/s^2.

    With the mass supplied `error` too high and the thrust as much too low (paper, Section IV-B).
    """
    mass_kg = flight.mass_kg * (1 + error)
    axis = flight.rotation.apply([0.0, 0.0, 1.0])
    force = axis * (flight.thrust_n * (1 - error))[:, None]
    if flight.drag_kgps is not None:
        force = force - through_air(flight, flight.velocity_mps)
    return force / mass_kg - np.array([0.0, 0.0, GRAVITY_MPS2])


def through_air(flight: Flight, velocity_mps: Floats, inverse: bool = False) -> Floats:
    """Return the drag's map of a velocity to a force, or its inverse, `[N, 3]`, world frame."""
    if flight.drag_kgps is None:
        return velocity_mps
    drag = np.asarray(flight.drag_kgps)
    body = flight.rotation.inv().apply(velocity_mps)
    return flight.rotation.apply(body / drag if inverse else body * drag)
