"""RotorPy's batched multirotor: body-rate control and the aerodynamics of its Hummingbird.

Its model is another one (rotor drag, quadratic drag, no per-motor limits on thrust), so only the
speed is compared. The step is ours, 2 ms; `rk4` is the faster of its integrators.
"""

import torch
from rotorpy.vehicles.hummingbird_params import quad_params
from rotorpy.vehicles.multirotor import BatchedMultirotor, BatchedMultirotorParams
from typing_extensions import override

from benchmarks.physics import VEHICLES
from benchmarks.side import Side
from faultpath.quadrotor.vehicle import PLANT_DT_S, STEPS_PER_CONTROL


class Hummingbirds(Side):
    """A control interval of every vehicle; the unit is a vehicle's step of 2 ms."""

    def __init__(self) -> None:
        torch.set_num_threads(1)
        self.amount = VEHICLES * STEPS_PER_CONTROL
        device = torch.device("cpu")
        parameters = BatchedMultirotorParams([quad_params] * VEHICLES, VEHICLES, device)

        def rows(*values: float) -> torch.Tensor:
            return torch.tensor(values, dtype=torch.float64).repeat(VEHICLES, 1)

        hover = quad_params["mass"] * 9.81
        speed = (hover / 4 / quad_params["k_eta"]) ** 0.5
        self._start = {
            "x": rows(0, 0, 0),
            "v": rows(0, 0, 0),
            "q": rows(0, 0, 0, 1),
            "w": rows(0, 0, 0),
            "wind": rows(3, -2, 1),
            "rotor_speeds": rows(speed, speed, speed, speed),
        }
        self._control = {"cmd_thrust": rows(hover), "cmd_w": rows(1.0, -0.5, 0.2)}
        self._plant = BatchedMultirotor(
            parameters, VEHICLES, self._start, device, control_abstraction="cmd_ctbr",
            integrator="rk4",
        )  # fmt: skip

    @torch.inference_mode()
    @override
    def work(self) -> None:
        state = self._start
        for _ in range(STEPS_PER_CONTROL):
            state = self._plant.step(state, self._control, PLANT_DT_S)
