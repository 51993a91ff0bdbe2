"""Why the true-parameter predictor errs: the vehicle replayed with what is known of its motors.

    python tools/motor_state.py RUN_FOLDER    a finished `faultpath reproduce --profile paper`

Replays the windows that probes use (selection library, flown with the true-parameter model)
through the plant itself, from the recorded state. A number of control intervals before the
present its motors start with equal shares of the recorded collective thrust, and follow the
recorded commands from there. Writes `docs/reference/motor-state.json`.
"""

import json
import sys
from pathlib import Path

import torch
from blocks import REFERENCE
from torch import Tensor

from faultpath.quadrotor import native
from faultpath.quadrotor.evidence.recording import blocks, recorded
from faultpath.quadrotor.models import Shelf, predictor
from faultpath.quadrotor.plant import PlantState, TorchPlant
from faultpath.quadrotor.plant.vehicle_batch import Vehicle
from faultpath.quadrotor.platform import Platform
from faultpath.quadrotor.platforms import FIRST
from faultpath.quadrotor.state import State
from faultpath.quadrotor.training.quality_rows import position_errors
from faultpath.quadrotor.training.windows import HISTORY, HORIZON, Windows
from faultpath.quadrotor.vehicle import STEPS_PER_CONTROL
from faultpath.studies.pages.in_text import PROBED

INTERVALS = (0, 1, 2, 4)
"""Control intervals before the present from which the motors' response is followed."""


def main() -> int:
    """Measure and write; return the exit status."""
    if len(sys.argv) != 2:
        print((__doc__ or "").partition("\n\n")[2], file=sys.stderr)
        return 2
    torch.set_num_threads(1)
    windows = recorded(blocks(PROBED, None), Path(sys.argv[1]) / "windows").windows
    with torch.inference_mode(), native.using(native.PORTABLE):
        found = {
            "windows": len(windows),
            "predictor_cm": _median_cm(_predicted(windows, FIRST)),
            "following_cm": _median_cm(
                _predicted(windows, FIRST.model_copy(update={"follows_motors": True}))
            ),
            "plant_cm": {str(n): _median_cm(_replayed(windows, n)) for n in INTERVALS},
        }
    (REFERENCE / "motor-state.json").write_text(json.dumps(found, indent=1) + "\n", "utf-8")
    return 0


def _predicted(windows: Windows, platform: Platform) -> Tensor:
    model = predictor("true-parameter", None, shelf=Shelf(platform))
    return position_errors(model, windows, wind="zero")[-1]


def _replayed(windows: Windows, intervals: int) -> Tensor:
    names = ("mass_kg", "thrust_scale", "torque_scale", "inertia_kgm2")
    names += ("motor_time_constant_s", "drag_kgps")
    plant = TorchPlant(Vehicle(**{name: getattr(windows, name).double() for name in names}))
    still = torch.zeros(STEPS_PER_CONTROL, 3, len(windows), dtype=torch.float64)
    first = HISTORY - intervals
    motors = (0.25 * windows.motor_thrust_n[first].double()).expand(4, -1).clone()
    for step in range(first, HISTORY):
        now = PlantState(_state(windows, step), motors)
        motors = plant.advance(now, windows.command[:, step].double(), still).thrusts
    now = PlantState(_state(windows, HISTORY), motors)
    for step in range(HISTORY, HISTORY + HORIZON):
        now = plant.advance(now, windows.command[:, step].double(), still)
    return (now.state.position - windows.position[:, HISTORY + HORIZON]).norm(dim=0)


def _state(windows: Windows, step: int) -> State:
    at = windows.state(step)
    return State(*(part.double() for part in (at.position, at.velocity, at.rotation, at.rate)))


def _median_cm(error: Tensor) -> float:
    return round(100 * float(error.median()), 2)


if __name__ == "__main__":
    sys.exit(main())
