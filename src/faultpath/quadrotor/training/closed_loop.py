"""Closed-loop flights under correct inputs, recorded at every control instant."""

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor

from faultpath.loop import Batch
from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.modules.vehicle import Flying, commanded
from faultpath.quadrotor.system import Quadrotor
from faultpath.quadrotor.training.flight import COMPONENTS, Flights
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
    rows: list[Tensor] = []
    world: World | None = None
    for instant in system.loop(variant, seed).execute(batch, taps):
        flying: Flying = instant.state
        world = flying.world
        none = world.state.position.new_full((4, len(world.lanes)), torch.nan)
        rows.append(_row(world, commanded(instant.inputs, world.lanes) if instant.inputs else none))
    assert world is not None
    return _flights(torch.stack(rows, 1).to(CPU), world, system, scenes)


def _row(world: World, command: Tensor) -> Tensor:
    """Return what is recorded at an instant, `[C, L]`, in the order of `COMPONENTS`."""
    state = world.state
    return torch.cat(
        [
            state.position,
            state.velocity,
            state.rotation.flatten(0, 1),
            state.rate,
            command,
            world.wind_mps,
            world.plant_state.thrusts.sum(0, keepdim=True),
        ]
    ).float()


def _flights(rows: Tensor, world: World, system: Quadrotor, scenes: Sequence[str]) -> Flights:
    """Cut flights off at the last instant before their trial ended."""
    assert rows.shape[0] == len(COMPONENTS)
    values = np.full((len(COMPONENTS), CONTROL_STEPS + 1, len(scenes)), np.nan, np.float32)
    values[:, : rows.shape[1]] = rows[..., : len(scenes)].numpy()
    time_s = world.progress.to(CPU).time_s.numpy()[: len(scenes)]
    steps = np.floor(time_s * CONTROL_RATE_HZ + 1e-6)
    vehicles = tuple(system.scene(scene).vehicle for scene in scenes)
    return Flights(values, steps.astype(np.int64), vehicles)
