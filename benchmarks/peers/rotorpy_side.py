"""RotorPy's batched multirotor: body-rate control and the aerodynamics of its Hummingbird.

Its model is another one (rotor drag, quadratic drag, no per-motor limits on thrust), so only the
speed is compared. The step is ours, 2 ms; `rk4` is the faster of its integrators.
"""

import torch
from faultpath_quadrotor.vehicle import PLANT_DT_S, STEPS_PER_CONTROL
from rotorpy.vehicles.hummingbird_params import quad_params
from rotorpy.vehicles.multirotor import BatchedMultirotor, BatchedMultirotorParams

from benchmarks.physics import VEHICLES
from benchmarks.side import Side


def hummingbirds() -> Side:
    """A control interval of every vehicle; the unit is a vehicle's step of 2 ms."""
    device = torch.device("cpu")
    parameters = BatchedMultirotorParams([quad_params] * VEHICLES, VEHICLES, device)

    def rows(*values: float) -> torch.Tensor:
        return torch.tensor(values, dtype=torch.float64).repeat(VEHICLES, 1)

    hover = quad_params["mass"] * 9.81
    speed = (hover / 4 / quad_params["k_eta"]) ** 0.5
    start = {
        "x": rows(0, 0, 0),
        "v": rows(0, 0, 0),
        "q": rows(0, 0, 0, 1),
        "w": rows(0, 0, 0),
        "wind": rows(3, -2, 1),
        "rotor_speeds": rows(speed, speed, speed, speed),
    }
    control = {"cmd_thrust": rows(hover), "cmd_w": rows(1.0, -0.5, 0.2)}
    plant = BatchedMultirotor(
        parameters, VEHICLES, start, device, control_abstraction="cmd_ctbr", integrator="rk4"
    )

    def work() -> None:
        state = start
        for _ in range(STEPS_PER_CONTROL):
            state = plant.step(state, control, PLANT_DT_S)

    return Side(work, VEHICLES * STEPS_PER_CONTROL)
