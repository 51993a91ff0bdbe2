"""How far the filter's estimates are from the truth in flight, and what it costs.

python experiments/state-errors/accuracy.py        # writes accuracy.json beside itself
"""

import json
import time
from pathlib import Path

import numpy as np
import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.device import arithmetic

from faultpath.loop import Batch, Observer
from faultpath.trials import Arm, SystemSpec, load_system
from faultpath.trials.attempt import taps_of

FILTERS = ("eskf", "eskf-no-bias", "eskf-cautious")
PRESENT = "predictor.initial_state"


class Present(Observer):
    """Keeps what the predictor is told of the state."""

    def __init__(self):
        self.now = {}

    def delivered(self, tap, reading, step, got):
        """See `Observer.delivered`."""
        if tap.consumer == PRESENT:
            self.now[tap.channel] = got


def fly(estimator: str, scenes: int) -> tuple[dict[str, np.ndarray], float, int]:
    """Return errors `[N]` by quantity over all running steps, seconds, and steps flown."""
    options = {"estimator": estimator, "wind": "L3"}
    system = load_system(SystemSpec(name="quadrotor", options=options))
    ids = tuple(each.id for each in system.library("selection").scenes[:scenes])
    seen = Present()
    taps = taps_of(system, Arm(variant="gru"), ids, observer=seen)
    apart = {"position": [], "velocity": [], "attitude": [], "body_rate": []}
    began, steps = time.perf_counter(), 0
    with arithmetic(), torch.inference_mode():
        for instant in system.loop("gru", 0).execute(Batch(ids, 0, system.control_dt_s), taps):
            if not instant.inputs:
                break
            steps += 1
            world, count = instant.state.world, len(ids)
            running, true = world.progress.running[:count], world.state.take(torch.arange(count))
            known = {name: value.movedim(0, -1) for name, value in seen.now.items()}
            turned = so3.log(so3.compose(true.rotation.transpose(0, 1), known["attitude"]))
            errors = {
                "position": known["position"] - true.position,
                "velocity": known["velocity"] - true.velocity,
                "attitude": turned * (180.0 / np.pi),
                "body_rate": known["body_rate"] - true.rate,
            }
            for name, error in errors.items():
                apart[name].append(error.norm(dim=0)[running].numpy())
    seconds = time.perf_counter() - began
    return {name: np.concatenate(each) for name, each in apart.items()}, seconds, steps


def main() -> None:
    """Measure and write."""
    found: dict[str, object] = {"library": "selection", "wind": "L3", "scenes": 100}
    for estimator in FILTERS:
        errors, _, _ = fly(estimator, 100)
        found[estimator] = {n: float(np.sqrt(np.mean(e**2))) for n, e in errors.items()}
    pace = {"exact": [], "eskf": []}
    for _ in range(3):
        for estimator, each in pace.items():
            _, seconds, steps = fly(estimator, 50)
            each.append(seconds / steps)
    found["step_ms"] = {name: 1000.0 * min(each) for name, each in pace.items()}
    text = json.dumps(found, indent=1) + "\n"
    Path(__file__).with_name("accuracy.json").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
