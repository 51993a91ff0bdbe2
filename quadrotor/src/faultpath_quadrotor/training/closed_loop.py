"""Closed-loop flights, recorded at every control instant."""

from collections.abc import Sequence

import numpy as np
import torch

from faultpath.loop import Batch
from faultpath.loop.taps import Taps
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.plant.module import ACTION, Flying
from faultpath_quadrotor.plant.world import CONTROL_STEPS
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training.recorded import Flights, blank_values, record
from faultpath_quadrotor.vehicle import CONTROL_RATE_HZ


@torch.inference_mode()
def record_flights(system: Quadrotor, variant: str, scenes: Sequence[str], seed: int) -> Flights:
    """Fly a block of scenes under correct inputs and return what it left behind.

    Scene by scene in their order. `seed` is that of the planner's noise and of the variant's
    training. A scene's flight is the same in any company, bit for bit.
    """
    wired = system.variants[variant]
    taps = Taps(
        system.interface,
        scenes=tuple(scenes),
        dt_s=system.control_dt_s,
        seed=seed,
        bindings=wired.bindings,
        consumers=wired.consumers,
        privileged=wired.privileged,
    )
    batch = Batch(tuple(scenes), seed, system.control_dt_s)
    values, world = blank_values(CONTROL_STEPS, len(scenes)), None
    for now in system.loop(variant, seed).execute(batch, taps):
        flying: Flying = now.state
        world = flying.world
        command = now.inputs[ACTION].T[:, world.lanes] if ACTION in now.inputs else None
        record(values, now.step, world.plant_state, world.wind_mps, command)
    assert world is not None
    time_s = world.progress.to(CPU).time_s.numpy()[: len(scenes)]
    # A flight ends with the last instant before its trial did.
    steps = np.floor(time_s * CONTROL_RATE_HZ + 1e-6).astype(np.int64)
    return Flights(values, steps, tuple(system.scene(scene).vehicle for scene in scenes))
