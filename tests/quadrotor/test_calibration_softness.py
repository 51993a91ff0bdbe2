"""What a calibration error does to a hovering vehicle, with either goal cost.

The vehicle settles where the planned acceleration makes up for the misjudged thrust. The terminal
cost is soft in height, so the offset is large; the running cost is stiff and hides the error. At
correct calibration the planner must not lean to either side, or one sign of the error would be
hidden.
"""

import pytest
import torch
from faultpath_quadrotor.planners import (
    MPPI,
    AutoregressiveSampler,
    CostWeights,
    NavigationCost,
    shift,
)
from faultpath_quadrotor.plant import TorchPlant
from faultpath_quadrotor.plant.vehicle_batch import Vehicle
from faultpath_quadrotor.predictors import Calibration, PredictorInputs
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import STEPS_PER_CONTROL
from planning_toys import replan

ERRORS = (0.0, 0.1, -0.1)
SECONDS = 4.0


def hover_heights(running):
    """Mean height offset over the second half of a hover, m, for each of `ERRORS`."""
    cost = NavigationCost(CostWeights(running=running))
    planner = MPPI(AutoregressiveSampler(), cost, temperature=0.1)
    lanes = 32
    plant = TorchPlant(Vehicle.nominal(lanes))
    rest = torch.zeros(3, lanes, dtype=torch.float64)
    now = plant.start(State.hover(rest, rest[0]))
    calm = torch.zeros(STEPS_PER_CONTROL, 3, lanes, dtype=torch.float64)
    errors = torch.tensor([*ERRORS, 0.0])[:, None]
    supplied = Calibration(1 + errors, 1 - errors)
    plan = planner.initial_plan(supplied.hover_thrust(9.81)[:, 0])
    steps = int(SECONDS * 20)
    heights = []
    for step in range(steps):
        state = now.state.take(torch.arange(4)).to(torch.float32)
        column = State(*(part[..., None] for part in vars(state).values()))
        inputs = PredictorInputs(column, supplied, supplied, supplied.mass_kg, torch.zeros(3, 4, 1))
        plan = replan(planner, inputs, plan, [f"hover/{i}" for i in range(4)], step)
        command = plan[0].double()[:, torch.arange(lanes).clamp(max=3)]
        now = plant.advance(now, command, calm)
        plan = shift(plan)
        heights.append(now.state.position[2, :3])
    return torch.stack(heights[steps // 2 :]).mean(0).tolist()


@pytest.fixture(scope="module")
def heights():
    with torch.inference_mode():
        return {"terminal": hover_heights(0.0), "running": hover_heights(1.0)}


def test_correct_calibration_leans_to_neither_side(heights):
    assert abs(heights["terminal"][0]) < 0.1
    assert abs(heights["running"][0]) < 0.1


def test_terminal_cost_shows_both_signs_alike(heights):
    _, high, low = heights["terminal"]
    assert high > 0.5
    assert low < -0.5
    assert 0.5 < high / -low < 2


def test_running_cost_is_stiffer(heights):
    for error in (1, 2):
        assert abs(heights["running"][error]) < 0.7 * abs(heights["terminal"][error])
