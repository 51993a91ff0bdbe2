"""Closed-loop flights, recorded at every control instant."""

from collections.abc import Sequence

import numpy as np
import torch

from faultpath.faults import AnyFault
from faultpath.loop import Batch, Instant
from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.plant.contact import Progress
from faultpath.quadrotor.plant.module import Flying
from faultpath.quadrotor.plant.world import CONTROL_STEPS, World
from faultpath.quadrotor.system import Quadrotor
from faultpath.quadrotor.training.recorded import Flights, record
from faultpath.quadrotor.vehicle import CONTROL_RATE_HZ
from faultpath.taps import Taps


def record_flights(system: Quadrotor, variant: str, scenes: Sequence[str], seed: int) -> Flights:
    """Fly a block of scenes under correct inputs and return what it left behind."""
    return fly_recorded(system, variant, scenes, seed)[0]


@torch.inference_mode()
def fly_recorded(
    system: Quadrotor,
    variant: str,
    scenes: Sequence[str],
    seed: int,
    faults: Sequence[AnyFault] = (),
) -> tuple[Flights, Progress]:
    """Fly a block of scenes and return what it left behind, and how the trials ended.

    Scene by scene in their order. `seed` is that of the planner's noise and of the variant's
    training. A scene's flight is the same in any company, bit for bit.
    """
    wired = system.variants[variant]
    taps = Taps(
        system.interface,
        faults,
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
    ended = world.progress.to(CPU)
    time_s = ended.time_s.numpy()[: len(scenes)]
    # A flight ends with the last instant before its trial did.
    steps = np.floor(time_s * CONTROL_RATE_HZ + 1e-6).astype(np.int64)
    vehicles = tuple(system.scene(scene).vehicle for scene in scenes)
    return Flights(values, steps, vehicles), ended


def _world(now: Instant) -> World:
    flying: Flying = now.state
    return flying.world
