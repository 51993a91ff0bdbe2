"""The isolated/shared reversal in one dimension: a cart with a shared gain estimate.

A cart accelerates by `gain * u + slope`. Two modules read the same estimate of the gain:

    controller   u = (wanted acceleration - estimated slope) / gain estimate
    observer     estimated slope = measured acceleration - gain estimate * u

Baseline `calibrated`: the observer uses the gain estimate. Repair `blind`: it uses the typical
gain 1 instead, so a wrong estimate cannot mislead it. Strike the observer alone and the repair
wins. Strike both, as one wrong estimate would, and the baseline wins: its two errors cancel.

    faultpath audit examples/toy.py:create --baseline calibrated --repair blind \
        --fault gain:scale=0.6 --library carts
"""

import hashlib

import numpy as np

from faultpath.interface import read_interface
from faultpath.streams import generator
from faultpath.taps import Reading, Taps
from faultpath.trials import Library, Outcome, SceneRef, Status, System, Variant

DT_S, STEPS, TOLERANCE_M = 0.1, 100, 0.25

INTERFACE = read_interface("""
name: toy
sources:
- {name: gain_estimate, unit: '1', provenance: estimated}
- {name: speedometer, unit: m/s, provenance: measured}
- {name: odometer, unit: m, provenance: measured}
- {name: observed_slope, unit: m/s^2, provenance: reconstructed}
channels:
- name: gain
  sources: [gain_estimate]
  consumers: [controller.inverse, observer.model]
  gap: fidelity
- {name: velocity, sources: [speedometer], consumers: [controller.feedback, observer.difference]}
- {name: position, sources: [odometer], consumers: [controller.feedback]}
- name: slope
  sources: [observed_slope]
  consumers: [controller.feedforward]
  gap: availability
reconstructs: {observer: observed_slope}
""")
EVERYONE = frozenset(c for channel in INTERFACE.channels for c in channel.consumers)


class Toy(System):
    name, control_dt_s, interface = "toy", DT_S, INTERFACE
    ends = {Status.TIMEOUT: "missed"}  # noqa: RUF012 - never changed
    variants = {  # noqa: RUF012 - never changed
        "calibrated": Variant("calibrated", "The observer reads the gain estimate.", EVERYONE),
        "blind": Variant("blind", "It assumes gain 1.", EVERYONE - {"observer.model"}),
    }

    def library(self, name: str) -> Library:
        scenes = tuple(SceneRef(f"cart/{i:03d}", i) for i in range(100))
        return Library(name, scenes, "carts-1")

    def run(self, variant, scenes, taps: Taps, seed):
        draws = [generator("toy/cart", scene, 0).uniform(size=3) for scene in scenes]
        gain, slope, goal = (np.array(draws) * [0.8, 4.0, 4.0] + [0.6, -2.0, 3.0]).T
        controller, observer = taps.for_module("controller"), taps.for_module("observer")
        position, velocity, before, u, estimate = np.zeros((5, len(scenes)))
        trace = [position]
        for step in range(STEPS):
            gauge = Reading(gain, "gain_estimate", step)
            speed = Reading(velocity, "speedometer", step)
            model = np.ones_like(gain)
            if variant == "calibrated":
                model = observer.deliver("gain", "model", gauge, step)
            now = observer.deliver("velocity", "difference", speed, step)
            if step > 0:  # there is no finished interval yet at the first step
                estimate = 0.5 * estimate + 0.5 * ((now - before) / DT_S - model * u)
            before = now

            place, hill = (
                Reading(position, "odometer", step),
                Reading(estimate, "observed_slope", step),
            )
            x = controller.deliver("position", "feedback", place, step)
            v = controller.deliver("velocity", "feedback", speed, step)
            lift = controller.deliver("slope", "feedforward", hill, step)
            u = (goal - x - 2.0 * v - lift) / controller.deliver("gain", "inverse", gauge, step)

            velocity = velocity + (gain * u + slope) * DT_S
            position = position + velocity * DT_S
            trace.append(position)
        missed = np.abs(goal - position)
        initial = [hashlib.sha256(draw.tobytes()).hexdigest()[:16] for draw in draws]
        path = np.stack([np.array(trace), *np.zeros((2, STEPS + 1, len(scenes)))], axis=-1)
        return [
            Outcome(
                scene=scene,
                status=Status.SUCCESS if missed[i] < TOLERANCE_M else Status.TIMEOUT,
                time_s=STEPS * DT_S,
                terminal_distance_m=float(missed[i]),
                min_clearance_m=None,
                initial_hash=initial[i],
                disturbance_hash=initial[i],
                planner_noise_hash="none",
                trace=path[:, i].astype(np.float32),
            )
            for i, scene in enumerate(scenes)
        ]


def create() -> System:
    return Toy()
