"""A two-link arm with a payload, simulated a scene at a time; `bare` does without faultpath.

    faultpath audit benchmarks/two_link.py:create --baseline calibrated --repair nominal \
        --fault payload:scale=0.5 --scenes 20
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from faultpath.core.streams import generator
from faultpath.system import ComposedSystem, Episode, FunctionPlant, Measure, Metric, writes

DT_S, STEPS = 0.01, 300
LENGTH_M, LINK_KG, GRAVITY = 0.5, 1.0, 9.81
GAINS, NOMINAL_KG = (100.0, 20.0), 1.5


def dynamics(payload_kg: Any, angle: Any, rate: Any) -> tuple[Any, Any]:
    """Return inertia `[..., 2, 2]` and the torques of motion and weight `[..., 2]`."""
    tip = (LINK_KG + payload_kg) * LENGTH_M
    first, second = angle[..., 0], angle[..., 1]
    coupled = tip * LENGTH_M * (1 + np.cos(second))
    twist = tip * LENGTH_M * np.sin(second)
    far = tip * LENGTH_M + 0 * second
    near = LINK_KG * LENGTH_M**2 + 2 * coupled
    inertia = np.stack([np.stack([near, coupled], -1), np.stack([coupled, far], -1)], -1)
    weight = tip * GRAVITY * np.cos(first + second)
    lifted = (tip + LINK_KG * LENGTH_M) * GRAVITY * np.cos(first) + weight
    turning = -twist * rate[..., 1] * (2 * rate[..., 0] + rate[..., 1])
    return inertia, np.stack([turning + lifted, twist * rate[..., 0] ** 2 + weight], -1)


@dataclass
class TwoLink:
    """The arm of one scene; `push` moves it in plain numbers, as many simulators do."""

    payload_kg: float
    goal: Any
    disturbance: Any
    angle: Any
    rate: Any

    def push(self, torque: Any, noise: Any) -> None:
        (q1, q2), (w1, w2) = self.angle.tolist(), self.rate.tolist()
        tip = (LINK_KG + self.payload_kg) * LENGTH_M
        for _ in range(4):
            cosine, sine = math.cos(q2), math.sin(q2)
            coupled, far = tip * LENGTH_M * (1 + cosine), tip * LENGTH_M
            near, twist = LINK_KG * LENGTH_M**2 + 2 * coupled, tip * LENGTH_M * sine
            weight = tip * GRAVITY * math.cos(q1 + q2)
            lifted = (tip + LINK_KG * LENGTH_M) * GRAVITY * math.cos(q1) + weight
            left = torque[0] + self.disturbance[0] + noise[0] - lifted + twist * w2 * (2 * w1 + w2)
            right = torque[1] + self.disturbance[1] + noise[1] - weight - twist * w1 * w1
            whole = near * far - coupled * coupled
            w1 += (far * left - coupled * right) / whole * DT_S / 4
            w2 += (near * right - coupled * left) / whole * DT_S / 4
            q1, q2 = q1 + w1 * DT_S / 4, q2 + w2 * DT_S / 4
        self.angle, self.rate = np.array([q1, q2]), np.array([w1, w2])


def start(rng: np.random.Generator) -> dict[str, Any]:
    goal, disturbance = rng.uniform(-1.0, 1.0, 2), rng.uniform(-2.0, 2.0, 2)
    arm = TwoLink(rng.uniform(0.5, 3.0), goal, disturbance, np.zeros(2), np.zeros(2))
    return _shown(arm)


def step(scene: dict[str, Any], torque: Any, rng: np.random.Generator) -> dict[str, Any]:
    scene["arm"].push(torque, rng.normal(0.0, 0.1, 2))
    return _shown(scene["arm"])


def _shown(arm: TwoLink) -> dict[str, Any]:
    return {
        "arm": arm,
        "angle": arm.angle,
        "rate": arm.rate,
        "goal": arm.goal,
        "payload": arm.payload_kg,
    }


def observer(payload: Any, angle: Any, rate: Any, torque: Any, memory: Any) -> tuple[Any, Any]:
    """Return the torque that the model does not explain."""
    inertia, load = dynamics(payload, angle, rate)
    if memory is None:
        return np.zeros_like(angle), (rate, np.zeros_like(angle))
    before, unexplained = memory
    needed = (inertia @ ((rate - before) / DT_S)[..., None])[..., 0] + load
    unexplained = 0.9 * unexplained + 0.1 * (needed - torque)
    return unexplained, (rate, unexplained)


def controller(payload: Any, angle: Any, rate: Any, goal: Any, unexplained: Any) -> Any:
    inertia, load = dynamics(payload, angle, rate)
    acceleration = GAINS[0] * (goal - angle) - GAINS[1] * rate
    return (inertia @ acceleration[..., None])[..., 0] + load - unexplained


OBSERVER = writes("unexplained", past="torque")(observer)
CONTROLLER = writes("torque", before=np.zeros(2))(controller)


def missed_rad(episode: Episode) -> float:
    """Return how far from its goal the arm ended."""
    return float(np.abs(episode["angle"][-1] - episode["goal"][-1]).max())


def create() -> ComposedSystem:
    """Return the system: its observer knows the payload, or takes the nominal one."""
    plant = FunctionPlant(
        start,
        step,
        observes={name: name for name in ("angle", "rate", "goal", "payload")},
        action="torque",
        steps=STEPS,
        dt_s=DT_S,
        succeeded=lambda episode: missed_rad(episode) < 0.05,
        metrics={"missed_rad": Measure(Metric(unit="rad", better="less"), missed_rad)},
    )
    units = {"angle": "rad", "rate": "rad/s", "goal": "rad", "payload": "kg"}
    return ComposedSystem(
        "two_link",
        plant,
        {
            "calibrated": [OBSERVER, CONTROLLER],
            "nominal": [OBSERVER.given(payload=NOMINAL_KG), CONTROLLER],
        },
        units | {"unexplained": "N m", "torque": "N m"},
    )


def bare(scene: str, observed: float | None, shown: float) -> float:
    """Run one scene without faultpath and return how far from its goal the arm ended.

    `observed` is the payload that the observer takes as a share of the true one, `None`: the
    nominal one; `shown` is that of the controller.
    """
    state = start(generator("plant/start", scene, 0))
    torque, memory = np.zeros(2), None
    for number in range(STEPS):
        payload, angle, rate = state["payload"], state["angle"], state["rate"]
        taken = NOMINAL_KG if observed is None else observed * payload
        unexplained, memory = observer(taken, angle, rate, torque, memory)
        torque = controller(shown * payload, angle, rate, state["goal"], unexplained)
        state = step(state, torque, generator("plant/step", scene, 0, number))
    return float(np.abs(state["angle"] - state["goal"]).max())
