"""A recorded flight on a grid of control intervals."""

from collections.abc import Mapping, Sequence
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
    grids, gaps = _grids(path, series)
    attitude = _attitude(path, columns, series)
    # NED: half turns about x on both sides, so that z is up in world and body.
    up = np.array([1.0, -1.0, -1.0]) if columns.frame == "NED" else np.ones(3)
    speed = [series[name] for name in columns.velocity.columns]
    command = series[columns.thrust.column]
    # A command holds until the next one: its integral is known at every time.
    done = np.concatenate([[0.0], np.cumsum(np.diff(command.time_s) * command.values[:-1])])
    parts: list[tuple[Floats, ...]] = []
    for number, grid in enumerate(grids):
        velocity = _on(grid, speed)
        velocity *= SPEED_UNITS[columns.velocity.unit] * up
        if columns.velocity.axes == "body":
            # Rounding may put the grid's end just beyond the last reading.
            velocity = attitude(np.clip(grid, *attitude.times[[0, -1]])).apply(velocity)
        middle = 0.5 * (grid[1:] + grid[:-1])
        last = np.clip(np.searchsorted(command.time_s, grid, side="right") - 1, 0, None)
        integral = done[last] + (grid - command.time_s[last]) * command.values[last]
        parts.append(
            (
                np.full(len(middle), float(number)),
                grid[:-1],
                attitude(middle).as_quat(),
                np.diff(velocity, axis=0) / INTERVAL_S,
                0.5 * (velocity[1:] + velocity[:-1]),
                np.diff(integral) / INTERVAL_S,
            )
        )
    stretch, time_s, quaternion, acceleration, speeds, thrust = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    rotation = Rotation.from_quat(quaternion)
    needed = acceleration + np.array([0.0, 0.0, GRAVITY_MPS2])
    explaining = columns.mass_kg * (needed * rotation.apply([0.0, 0.0, 1.0])).sum(1)
    factor = columns.thrust.newton_per_unit
    if factor == "fit":
        power = float((thrust**2).sum())
        factor = float((thrust * explaining).sum()) / power if power else 0.0
    carried = float(np.median(factor * thrust)) / (columns.mass_kg * GRAVITY_MPS2)
    if not 0.5 <= carried <= 2.0:
        raise UserError(
            f"{path}: the median thrust is {carried:.3g} times the weight: correct mass_kg, or "
            "newton_per_unit of the thrust (a factor, or fit)"
        )
    flight = Flight(
        stretch=stretch,
        time_s=time_s,
        rotation=rotation,
        acceleration_mps2=acceleration,
        velocity_mps=speeds,
        thrust_n=factor * thrust,
        mass_kg=columns.mass_kg,
        drag_kgps=columns.drag_kgps,
        newton_per_unit=factor,
        gaps=gaps,
    )
    _check_order(path, columns, flight)
    if columns.check_frame:
        _check_frame(path, columns.frame, flight)
    return flight


def _grids(path: Path, series: Mapping[str, LogColumn]) -> tuple[list[Floats], int]:
    """Return the ends of the control intervals of each stretch, and how many pauses there are."""
    columns = list(series.values())
    pauses: list[tuple[float, float]] = []
    for column in columns:
        steps = np.diff(column.time_s)
        long = steps > max(_GAP * float(np.median(steps)), 2 * INTERVAL_S)
        pauses += zip(column.time_s[:-1][long], column.time_s[1:][long], strict=True)
    merged: list[tuple[float, float]] = []
    for before, after in sorted(pauses):
        if merged and before < merged[-1][1]:
            merged[-1] = merged[-1][0], max(merged[-1][1], after)
        else:
            merged.append((before, after))
    starts = [max(float(column.time_s[0]) for column in columns), *(after for _, after in merged)]
    end = min(float(column.time_s[-1]) for column in columns)
    stops = [*(before for before, _ in merged), end]
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
    return grids, len(merged)


def _on(time_s: Floats, columns: Sequence[LogColumn]) -> Floats:
    """Return columns interpolated at some times, `[T, columns]`."""
    return np.stack([np.interp(time_s, column.time_s, column.values) for column in columns], axis=1)


def _attitude(path: Path, columns: ColumnMap, series: Mapping[str, LogColumn]) -> Slerp:
    components = [series[name] for name in columns.attitude.columns]
    time_s = components[0].time_s
    quaternion = _on(time_s, components)
    lengths = np.linalg.norm(quaternion, axis=1)
    if abs(float(np.median(lengths)) - 1) > 0.02:
        raise UserError(
            f"{path}: the attitude has the length {np.median(lengths):.3g}, and a unit quaternion "
            "has 1: correct its columns"
        )
    if (odd := np.flatnonzero(abs(lengths - 1) > 0.5)).size:
        raise UserError(
            f"{path}: the attitude has the length {lengths[odd[0]]:.3g} at its reading {odd[0]}, "
            "and a unit quaternion has 1: leave such cells empty"
        )
    if columns.attitude.order == "wxyz":
        quaternion = quaternion[:, [1, 2, 3, 0]]
    if columns.frame == "NED":
        x, y, z, w = quaternion.T
        quaternion = np.stack([x, -y, -z, w], axis=1)
    return Slerp(time_s, Rotation.from_quat(quaternion))


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
