"""A rover docks by a rangefinder: `docs/own-loop.md` goes through this file.

Two modules. The approach brakes along a speed profile over the range that is left. The
speedometer reconstructs the speed from successive ranges. Baseline `wheels`: the approach reads
its speed from the wheels, which slip. Repair `ranges`: it reads the reconstructed speed, so that
the rangefinder now reaches the command on two ways.

    faultpath audit examples/dock.py:create --baseline wheels --repair ranges \
        --fault range:scale=0.7 --library floors
"""

# --- interface ---
import hashlib
from collections.abc import Sequence

import numpy as np

from faultpath import UserError, generator
from faultpath.system import (
    Library,
    Metric,
    Outcome,
    Reading,
    SceneRef,
    Status,
    System,
    Taps,
    Variant,
    read_interface,
)

INTERFACE = read_interface("""
name: dock
sources:
- {name: rangefinder, unit: m, provenance: measured}
- {name: wheel_odometry, unit: m/s, provenance: measured}
- {name: range_rate, unit: m/s, provenance: reconstructed}
channels:
- name: range
  sources: [rangefinder]
  readers: [approach.profile, speedometer.difference]
  gap: fidelity
- name: speed
  sources: [wheel_odometry, range_rate]
  readers: [approach.feedback]
  gap: availability
reconstructs: {speedometer: range_rate}
""")

# --- declarations ---
APPROACH = frozenset({"approach.profile", "approach.feedback"})
WHEELS = Variant("wheels", "The wheels give the speed.", readers=APPROACH)
RANGES = Variant(
    "ranges",
    "Successive ranges give the speed.",
    readers=APPROACH | {"speedometer.difference"},
    bindings={"speed": "range_rate"},
)


class Dock(System):
    name, control_dt_s, interface = "dock", 0.1, INTERFACE
    metrics = {  # noqa: RUF012 - never changed
        "terminal_distance_m": Metric(
            unit="m",
            better="less",
            words="terminal distance",
            title="Distance to the goal at the end",
        )
    }
    ends = {Status.TIMEOUT: "stopped short"}  # noqa: RUF012 - never changed
    variants = {"wheels": WHEELS, "ranges": RANGES}  # noqa: RUF012 - never changed

    def library(self, name: str) -> Library:
        if name != "floors":
            raise UserError(f"the dock has no library '{name}': it has floors.")
        scenes = tuple(SceneRef(f"floors/{i:03d}", i) for i in range(100))
        return Library(name, scenes, content_hash="floors-1")

    # --- run ---
    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> list[Outcome]:
        draws = [generator("dock/floor", scene, 0).uniform(size=3) for scene in scenes]
        distance, shown, grip = (np.array(draws) * [3.0, 0.45, 1.5] + [3.0, 0.55, 1.1]).T
        approach, speedometer = taps.for_module("approach"), taps.for_module("speedometer")
        speed, before = np.zeros((2, len(scenes)))
        for step in range(150):
            gauge = Reading(distance, "rangefinder", step)
            if variant == "ranges":
                measured = speedometer.deliver("range", "difference", gauge, step)
                rate = (before - measured) / self.control_dt_s if step else speed
                seen, before = Reading(rate, "range_rate", step), measured
            else:
                seen = Reading(shown * speed, "wheel_odometry", step)

            left = np.maximum(approach.deliver("range", "profile", gauge, step), 0.0)
            desired = np.minimum(np.sqrt(2.0 * left), 0.8 * left)
            push = 3.0 * (desired - approach.deliver("speed", "feedback", seen, step))
            speed = np.maximum(speed + np.clip(push, -grip, grip) * self.control_dt_s, 0.0)
            distance = distance - speed * self.control_dt_s

        # --- outcomes ---
        return [
            Outcome(
                scene=scene,
                status=status(distance[i]),
                time_s=150 * self.control_dt_s,
                initial_hash=(drawn := hashlib.sha256(draws[i].tobytes()).hexdigest()),
                disturbance_hash=drawn,
                planner_noise_hash="none",
                metrics={"terminal_distance_m": abs(float(distance[i]))},
            )
            for i, scene in enumerate(scenes)
        ]


def status(distance_m: float) -> Status:
    if distance_m < -0.2:  # the buffer gives way by this much
        return Status.CRASH
    return Status.SUCCESS if distance_m < 0.2 else Status.TIMEOUT


def create() -> System:
    return Dock()
