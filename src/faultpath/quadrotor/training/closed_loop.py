"""Closed-loop flights under correct inputs, recorded at every control instant."""

from collections.abc import Sequence

import numpy as np
import torch

from faultpath.loop import Batch, Instant
from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.modules.vehicle import Flying
from faultpath.quadrotor.system import Quadrotor
from faultpath.quadrotor.training.recorded import Flights, record
from faultpath.quadrotor.vehicle import CONTROL_RATE_HZ
from faultpath.quadrotor.world import CONTROL_STEPS, World
from faultpath.taps import Taps


@torch.inference_mode()
def record_flights(system: Quadrotor, variant: str, scenes: Sequence[str], seed: int) -> Flights:
    """Fly a block of scenes and return what it left behind, scene by scene in their order.

    `seed` is that of the planner's noise and of the variant's training. A scene's flight is the
    same in any company, bit for bit.
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
    instants = system.loop(variant, seed).execute(batch, taps)
    values, world = record(((now, _world(now)) for now in instants), len(scenes), CONTROL_STEPS)
    time_s = world.progress.to(CPU).time_s.numpy()[: len(scenes)]
    # A flight ends with the last instant before its trial did.
    steps = np.floor(time_s * CONTROL_RATE_HZ + 1e-6).astype(np.int64)
    return Flights(values, steps, tuple(system.scene(scene).vehicle for scene in scenes))


def _world(now: Instant) -> World:
    flying: Flying = now.state
    return flying.world
