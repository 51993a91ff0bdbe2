"""The isolated/shared reversal in one dimension: a cart with a shared gain estimate.

A cart accelerates by `gain * push + slope`. Two modules read the same estimate of the gain:

    controller   push = (wanted acceleration - estimated slope) / gain estimate
    observer     estimated slope = measured acceleration - gain estimate * push

Baseline `calibrated`: the observer uses the estimate. Repair `blind`: it uses 1, the gain on the
nameplate, which is right to 15 % and which no wrong estimate can spoil; it costs next to nothing.
Corrupt the observer's estimate alone and the repair wins. Corrupt both, as one wrong estimate
would, and the baseline wins: its two errors cancel.

    faultpath audit examples/toy.py:create --baseline calibrated --repair blind \
        --fault gain:scale=0.6 --library carts
"""

import hashlib
from dataclasses import dataclass, replace

import numpy as np

from faultpath import UserError, generator
from faultpath.system import (
    ErrorSum,
    ErrorTerm,
    FloorPlan,
    Library,
    LoopSystem,
    Metric,
    Module,
    Plant,
    Port,
    Progress,
    SceneRef,
    Status,
    System,
    interface_of,
)

DT_S, STEPS, TOLERANCE_M = 0.1, 100, 0.25

FACTS = """
name: toy
sources:
- {name: gain_estimate, unit: '1', provenance: estimated}
- {name: speedometer, unit: m/s, provenance: measured}
- {name: odometer, unit: m, provenance: measured}
- {name: observed_slope, unit: m/s^2, provenance: reconstructed}
- {name: goal, unit: m, provenance: commanded}
- {name: command, unit: m/s^2, provenance: commanded}
channels:
- {name: gain, sources: [gain_estimate], gap: fidelity}
- {name: velocity, sources: [speedometer]}
- {name: position, sources: [odometer]}
- {name: slope, sources: [observed_slope], gap: availability}
- {name: target, sources: [goal]}
- {name: push, sources: [command]}
"""


def drawn(scene):
    """Return the three numbers that decide a scene, and what they make of gain, slope and goal."""
    draw = generator("toy/cart", scene, 0).uniform(size=3)
    return draw, draw * [0.3, 4.0, 4.0] + [0.85, -2.0, 3.0]


@dataclass(frozen=True)
class Carts:
    """`draws` `[B, 3]` is what decides a scene; every other array is `[B]`."""

    draws: np.ndarray
    gain: np.ndarray
    slope: np.ndarray
    goal: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    step: int = 0


class Cart(Plant):
    name, steps = "cart", STEPS
    # The source `gain_estimate` itself stays correct: a fault acts where a module reads it.
    senses = ("gain_estimate", "speedometer", "odometer", "goal")
    reads = frozenset({Port("push", "motor")})

    def start(self, batch):
        draws, values = map(np.array, zip(*map(drawn, batch.scenes), strict=True))
        gain, slope, goal = values.T
        return Carts(draws, gain, slope, goal, *np.zeros((2, len(draws))))

    def sense(self, carts):
        values = carts.gain, carts.velocity, carts.position, carts.goal
        return dict(zip(self.senses, values, strict=True))

    def advance(self, carts, inputs):
        velocity = carts.velocity + (carts.gain * inputs["push", "motor"] + carts.slope) * DT_S
        position = carts.position + velocity * DT_S
        return replace(carts, velocity=velocity, position=position, step=carts.step + 1)

    def progress(self, carts):
        missed = np.abs(carts.goal - carts.position)
        running = np.full(len(missed), carts.step < STEPS)
        return Progress(
            running=running,
            succeeded=~running & (missed < TOLERANCE_M),
            crashed=np.zeros(len(missed), bool),
            time_s=np.full(len(missed), carts.step * DT_S),
            metrics={"terminal_distance_m": missed},
        )

    def conditions(self, carts):
        hashes = [hashlib.sha256(draw.tobytes()).hexdigest()[:16] for draw in carts.draws]
        return hashes, hashes  # one draw decides both the initial state and the disturbance

    def position(self, carts):
        return np.stack([carts.position, *np.zeros((2, len(carts.position)))], axis=-1)


class Observer(Module):
    name, writes = "observer", ("observed_slope",)
    reads_past = frozenset({Port("push", "executed")})

    def __init__(self, calibrated: bool):
        gauge = {Port("gain", "model")} if calibrated else set()
        self.reads = frozenset({Port("velocity", "difference"), *gauge})

    def step(self, inputs, memory):
        velocity = inputs["velocity", "difference"]
        gain = inputs.get(Port("gain", "model"), 1.0)
        if memory is None:  # there is no finished interval yet at the first step
            estimate = np.zeros_like(velocity)
        else:
            last_velocity, estimate = memory
            acceleration = (velocity - last_velocity) / DT_S
            estimate = 0.5 * estimate + 0.5 * (acceleration - gain * inputs["push", "executed"])
        return {"observed_slope": estimate}, (velocity, estimate)


class Controller(Module):
    name, writes = "controller", ("command",)
    reads = frozenset(
        {
            Port("gain", "inverse"),
            Port("position", "feedback"),
            Port("velocity", "feedback"),
            Port("slope", "feedforward"),
            Port("target", "reference"),
        }
    )

    def before(self, batch):
        return {"command": np.zeros(len(batch.scenes))}

    def step(self, inputs, memory):
        left = inputs["target", "reference"] - inputs["position", "feedback"]
        acceleration = left - 2.0 * inputs["velocity", "feedback"] - inputs["slope", "feedforward"]
        return {"command": acceleration / inputs["gain", "inverse"]}, memory


def gain_error(trial):
    """Return by how much the controller misjudges what its push does, m/s^2."""
    wrong = trial.delivered("gain", "controller.inverse") - trial.source("gain_estimate")
    return wrong * trial.source("command")


def slope_error(trial):
    """Return by how much the slope that it is given is wrong, m/s^2."""
    speed, push = trial.source("speedometer"), trial.source("command")
    moved = np.diff(speed, axis=0, append=np.nan) / DT_S
    return trial.delivered("slope", "controller.feedforward") - (
        moved - trial.source("gain_estimate") * push
    )


class Toy(LoopSystem):
    name, control_dt_s = "toy", DT_S
    interface = interface_of(FACTS, (Controller(), Observer(calibrated=True), Cart()))
    metrics = {  # noqa: RUF012 - never changed
        "terminal_distance_m": Metric(
            unit="m",
            better="less",
            words="terminal distance",
            title="Distance to the goal at the end",
        )
    }
    ends = {Status.TIMEOUT: "missed"}  # noqa: RUF012 - never changed
    descriptions = {  # noqa: RUF012 - never changed
        "calibrated": "The observer works with the gain estimate, right or wrong.",
        "blind": "The observer takes the nameplate's gain, 1, and no estimate.",
    }
    # Only for the report: what the controller believes of the acceleration, minus the truth.
    errors = ErrorSum(
        "error of the expected acceleration",
        "m/s^2",
        (
            ErrorTerm("controller: wrong gain", gain_error),
            ErrorTerm("observer: wrong slope", slope_error),
        ),
    )

    def plant(self):
        return Cart()

    def modules(self, variant, seed):
        return Observer(variant == "calibrated"), Controller()

    def library(self, name: str) -> Library:
        if name not in ("carts", "selection", "held-out"):  # the last two where a verb names none
            raise UserError(f"the toy has no library '{name}': its only one is carts.")
        scenes = tuple(SceneRef(f"cart/{i:03d}", i) for i in range(100))
        return Library("carts", scenes, "carts-2")

    def floor_plan(self, scene: str) -> FloorPlan:
        """Return what a report draws: the rail and the goal on it."""
        start, end, goal = (0.0, 0.0, 0.0), (8.0, 0.0, 0.0), (float(drawn(scene)[1][2]), 0.0, 0.0)
        return FloorPlan(start, end, prisms=(), pillars=(), start=start, goal=goal, title=scene)


def create() -> System:
    return Toy()
