"""The device of a flight: everything is there, and no control step waits for it.

Most of this needs no GPU. What a GPU computes is simulated by shape and place alone; what its way
through the program brings is flown on the CPU; a machine that has one flies both and compares.
"""

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import pytest
import torch
from faultpath_quadrotor import device as devices
from faultpath_quadrotor import models, native, system
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.plant.module import ACTION
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.system import Quadrotor
from flights import HELD_OUT, fault, fly, quadrotor, trace
from simulated_gpu import GPU, SimulatedGPU, simulated_gpu

from faultpath.core import arrays
from faultpath.core.errors import UserError
from faultpath.faults import at_readers
from faultpath.loop import Batch, DeliveryListener, Query, Reading, Tap, Taps
from faultpath.run.attempt import taps_of
from faultpath.run.plan import Treatment

LEARNED = {"predictor": "wm-a-wind", "clearance": "depth", "wind": "L3"}
UNANCHORED = {"clearance": "depth", "wind": "L1"}
ANALYTIC = {"predictor": "true-parameter", "sampler": "mode-preserving", "clearance": "true"}
FLIGHTS = [
    (LEARNED, "gru", ("attitude:noise=0.05", "clearance:noise=0.1", "depth:hold=2")),
    (UNANCHORED, "wm-u", ("history_code:freeze", "action:erase=9.8/0/0/0@vehicle,onset=1")),
    (ANALYTIC, "dob", ("noisy_state=1", "wind:delay=1", "action:dropout=0.3")),
]


class Placed(DeliveryListener):
    """Looks where every reading is, and where what is delivered is."""

    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        if not isinstance(reading.value, Query):
            assert reading.value.device == got.device == GPU, str(tap)

    def answered(self, tap, query, step, request, answer, got) -> None:
        assert query.value(got).device == GPU, str(tap)


@pytest.fixture
def gpu(monkeypatch: pytest.MonkeyPatch) -> Iterator[SimulatedGPU]:
    """A simulated GPU that the program takes for one of CUDA; plans look four steps ahead."""
    near = PLATFORM.planner.sampler.model_copy(update={"horizon": 4})
    monkeypatch.setattr(QuadrotorOptions, "sampling", near)
    monkeypatch.setattr(QuadrotorOptions, "place", GPU)
    monkeypatch.setattr(arrays, "_PINNING", {GPU.type})
    with simulated_gpu() as simulated:
        yield simulated
    _forget()


def _forget() -> None:
    """Empty what is kept from flight to flight."""
    kept = (models.predictor, models.reconstruction, models.clearance_model, arrays._constant_array)
    for cached in (*kept, system._field, system._renderer):
        cached.cache_clear()


def _system(options: dict[str, str]) -> Quadrotor:
    """Return a quadrotor for CUDA, past the question whether there is any."""
    parsed = QuadrotorOptions.model_validate({**options, "device": "cuda"})
    return Quadrotor(parsed)


def _wired(
    built: Quadrotor,
    variant: str,
    texts: Sequence[str],
    scenes: Sequence[str],
    observer: DeliveryListener | None = None,
) -> Taps:
    readers = built.variants[variant].readers
    faults = at_readers([part for text in texts for part in fault(text, built)], readers)
    return taps_of(built, Treatment(variant=variant, faults=faults), scenes, observer=observer)


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is a GPU here, which flies below")
@pytest.mark.parametrize(("options", "variant", "texts"), FLIGHTS, ids=["gru", "wm-u", "dob"])
def test_control_steps_stay_on_the_device_and_never_wait(options, variant, texts, gpu):
    built, scenes = _system(options), HELD_OUT[:3]
    taps = _wired(built, variant, texts, scenes, Placed())
    steps = built.loop(variant, seed=0).execute(Batch(scenes, 0, built.control_dt_s), taps)
    gpu.watching = True
    assert next(steps).inputs[ACTION].device == GPU
    second = next(steps)
    assert second.inputs[ACTION].device == GPU
    world = second.state.world
    for part in (*vars(world.state).values(), *vars(world.progress).values(), world.wind_mps):
        assert part.device == GPU
    assert gpu.operations > 1000


def test_learned_modules_fly_the_same_to_rounding_the_way_of_a_device(monkeypatch):
    """The way of an accelerator, while tensors are on the CPU."""
    monkeypatch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", 5)
    monkeypatch.setattr("faultpath_quadrotor.plant.module.LOOK_EVERY", 2)
    with native.using(native.PORTABLE):
        flyer = quadrotor(**LEARNED)
        noise = fault("attitude:noise=0.05", flyer)
        usual, _ = fly(flyer, "gru", HELD_OUT[:2], noise)
        monkeypatch.setattr(devices, "HOST_READABLE", frozenset())
        _forget()
        other, _ = fly(flyer, "gru", HELD_OUT[:2], noise)
    _forget()
    for one, two in zip(usual, other, strict=True):
        assert one.status is two.status
        assert one.planner_noise_hash == two.planner_noise_hash
        assert trace(two) == pytest.approx(trace(one), abs=1e-4)


def test_the_device_is_part_of_the_fingerprint_decides_the_blocks_and_must_be_there():
    cpu, cuda = Quadrotor(QuadrotorOptions()), _system({})
    assert cpu.fingerprint() != cuda.fingerprint()
    assert cpu.block_size < cuda.block_size == len(cuda.library("held-out").scenes)
    if not torch.cuda.is_available():
        with pytest.raises(UserError, match=r"device 'cuda' needs a GPU, .* leave --device out"):
            quadrotor(device="cuda")


@contextmanager
def _no_waiting() -> Iterator[None]:
    """Let torch raise where the host waits for the GPU."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Synchronization debug mode is a prototype")
        try:
            torch.cuda.set_sync_debug_mode("error")
            yield
        finally:
            torch.cuda.set_sync_debug_mode("default")


@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a GPU")
@pytest.mark.parametrize(("options", "variant", "texts"), FLIGHTS, ids=["gru", "wm-u", "dob"])
def test_a_gpu_flies_what_the_cpu_flies_and_never_waits(options, variant, texts, monkeypatch):
    """To 1 mm after a second of flight; torch itself raises where a step waits."""
    monkeypatch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", 20)
    here, there = quadrotor(**options), quadrotor(**options, device="cuda")
    with torch.no_grad():
        taps = _wired(there, variant, texts, HELD_OUT)
        steps = there.loop(variant, seed=0).execute(Batch(HELD_OUT, 0, there.control_dt_s), taps)
        next(steps)  # libraries are loaded
        with _no_waiting():
            next(steps)
    flights = [(built, _wired(built, variant, texts, HELD_OUT)) for built in (here, there)]
    ends = [built.run(variant, HELD_OUT, taps, 0) for built, taps in flights]
    for one, two in zip(*ends, strict=True):
        assert trace(two) == pytest.approx(trace(one), abs=1e-3)
