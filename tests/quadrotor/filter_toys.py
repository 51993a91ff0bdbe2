"""Flights of a vehicle on random courses, and what its sensors read there."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.estimators import ErrorStateFilter
from faultpath_quadrotor.estimators.eskf import Filtered
from faultpath_quadrotor.estimators.kalman import Trust
from faultpath_quadrotor.estimators.sensors import SENSORS, SensorErrors, readings, sensors
from faultpath_quadrotor.plant import TorchPlant
from faultpath_quadrotor.plant.protocol import Vehicle
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import VehicleParameters
from torch import Tensor

LANES = 32
BIASED = SENSORS[:2]


def courses(steps: int) -> tuple[list[State], list[Mapping[str, Tensor]]]:
    """Return the states at each step, and what exact sensors read, of 32 vehicles from rest."""
    draw = np.random.default_rng(7)
    plant = TorchPlant(Vehicle.stack([VehicleParameters()] * LANES))
    yaw = torch.from_numpy(draw.uniform(-3, 3, LANES))
    now = plant.start(State.hover(torch.zeros(3, LANES, dtype=torch.float64), yaw))
    passed, states, read = [now.state] * 6, list[State](), list[Mapping[str, Tensor]]()
    calm = torch.zeros(5, 3, LANES, dtype=torch.float64)
    for step in range(steps):
        if step % 20 == 0:
            goal = torch.from_numpy(draw.uniform(-2, 2, (3, LANES)))
            turning = torch.from_numpy(draw.uniform(-1, 1, LANES))
        here = now.state
        states.append(here)
        read.append(readings(passed))
        pull = 2.0 * (goal - here.position) - 2.0 * here.velocity
        pull[2] += 9.81
        up = here.rotation[:, 2]
        tilt = torch.linalg.cross(up, pull / pull.norm(dim=0), dim=0)
        rate = 6.0 * so3.rotate_back(here.rotation, tilt)
        rate[2] = turning
        command = torch.cat(((pull * up).sum(0)[None], rate))
        passed = [here]
        for _ in range(5):
            now = plant.advance(now, command, calm)
            passed.append(now.state)
    return states, read


@dataclass(frozen=True)
class Sensed:
    """What erring sensors of many flights read, `[..., lanes]`, and the biases in it."""

    read: Sequence[Mapping[str, Tensor]]
    biases: Sequence[Tensor]
    """Of gyroscope and accelerometer, `[6, lanes]` a step."""

    @classmethod
    def of(cls, exact: Sequence[Mapping[str, Tensor]], repeats: int, size: float = 1.0) -> "Sensed":
        """Fly each course `repeats` times; fixes arrive as late as they are declared to."""
        known, steps = sensors(), len(exact)
        names = [f"course/{lane}" for lane in range(LANES * repeats)]
        errors = SensorErrors(names, 0, size, known, steps)
        still = {name: replace(each, noise=0.0) for name, each in known.items()}
        biased = SensorErrors(names, 0, size, still, steps)
        found: list[dict[str, Tensor]] = []
        biases: list[Tensor] = []
        for step, given in enumerate(exact):
            each = {name: given[name].movedim(-1, 0) for name in SENSORS}
            many = {n: value.repeat(repeats, *[1] * (value.ndim - 1)) for n, value in each.items()}
            wrong = {n: errors.on(n, step, many[n]).movedim(0, -1) for n in SENSORS}
            found.append({n: value.contiguous() for n, value in wrong.items()})
            none = {name: torch.zeros_like(many[name]) for name in BIASED}
            biases.append(torch.cat([biased.on(n, step, none[n])[:, 0].T for n in BIASED]))
        late = known["position_fix"].late
        taken = [max(0, (step - late) // 2 * 2) for step in range(steps)]
        fixes = [{"position_fix": found[step]["position_fix"]} for step in taken]
        read = [now | fix for now, fix in zip(found, fixes, strict=True)]
        return cls(read, biases)


def filtered(sensed: Sensed, start: Tensor | None = None) -> Iterator[Filtered]:
    """Run the filter that ships; `start` `[6, lanes]` is the error with which it begins."""
    eskf = ErrorStateFilter(Trust(sensors()))
    past: Filtered | None = None
    for step, read in enumerate(sensed.read):
        if past is not None:
            past = eskf.taken(past, read, step)
        else:
            past = eskf.begun(read)
            if start is not None:
                belief = past.belief
                turned = so3.compose(belief.rotation, so3.exp(start[3:]))
                begun = replace(belief, velocity=start[:3].clone(), rotation=turned)
                past = replace(past, belief=begun)
        yield past
