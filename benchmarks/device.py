"""Time flights on this machine's processor and on its GPU; `device.json` keeps the figures.

python -m benchmarks.device                          time control steps, on a machine with a GPU
python -m benchmarks.device --audits CPU_RUN GPU_RUN add one audit, flown on both

One process on one core flies blocks of 50 scenes with the fastest kernels, as a worker of an audit
does; one process feeds the GPU blocks of 100 scenes, as `--device cuda` does, and of 300. Both fly
the GRU in the strongest wind with the model of depth. The first steps, in which libraries load,
are not counted.
"""

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import torch
from faultpath_quadrotor import native
from faultpath_quadrotor.device import arithmetic
from faultpath_quadrotor.system import Quadrotor
from torch.profiler import ProfilerActivity, profile

from benchmarks.results import DEVICE
from faultpath.loop import Batch
from faultpath.trials import Arm, SystemSpec, load_system
from faultpath.trials.attempt import taps_of

FLOWN = {"predictor": "wm-a-wind", "clearance": "depth", "wind": "L3"}
SIZES = {"cpu": (50,), "cuda": (100, 300)}
VARIANT, WARM_UP, STEPS = "gru", 5, 20


def main() -> None:
    """Measure, or compare two audits, and keep the figures."""
    parser = argparse.ArgumentParser(prog="benchmarks.device")
    parser.add_argument("--audits", nargs=2, type=Path, metavar=("CPU_RUN", "GPU_RUN"))
    parser.add_argument("--out", type=Path, default=DEVICE, help="the JSON file of the figures")
    options = parser.parse_args()
    figures = json.loads(options.out.read_text()) if options.out.is_file() else {}
    if options.audits:
        figures["audits"] = compared(*options.audits)
    elif torch.cuda.is_available():
        figures |= measured()
    else:
        parser.error("there is no GPU here: run it on a machine that has one")
    options.out.write_text(json.dumps(figures, indent=1) + "\n")
    print(options.out.read_text())


def measured() -> dict[str, Any]:
    """Return what control steps take on each device."""
    kernels = native.kernels()
    return {
        "gpu": torch.cuda.get_device_name(),
        "torch": torch.__version__,
        "kernels": native.PORTABLE if kernels is None else kernels.isa,
        "steps": [timed(device, size) for device, many in SIZES.items() for size in many],
    }


def timed(device: str, size: int) -> dict[str, Any]:
    """Fly `STEPS` control steps of `size` scenes; return what one takes, ms, and more of a GPU."""
    built = load_system(SystemSpec(name="quadrotor", options={**FLOWN, "device": device}))
    assert isinstance(built, Quadrotor)
    scenes = tuple(scene.id for scene in built.library("confirmation").scenes[:size])
    taps = taps_of(built, Arm(variant=VARIANT, faults=()), scenes)
    with torch.no_grad(), arithmetic():
        steps = built.loop(VARIANT, seed=0).execute(Batch(scenes, 0, built.control_dt_s), taps)
        _step(steps, WARM_UP, device)
        begun = time.perf_counter()
        _step(steps, STEPS, device)
        step_ms = (time.perf_counter() - begun) / STEPS * 1e3
        rest = _profiled(steps) if device == "cuda" else {}
    return {"device": device, "scenes": size, "step_ms": step_ms, **rest}


def _step(steps: Iterator[Any], count: int, device: str) -> None:
    for _ in range(count):
        next(steps)
    if device == "cuda":
        torch.cuda.synchronize()


def _profiled(steps: Iterator[Any]) -> dict[str, float]:
    """Return the kernels of one control step, how long they compute, and the memory in use."""
    both = [ProfilerActivity.CUDA, ProfilerActivity.CPU]
    with profile(activities=both, acc_events=True) as watched:
        _step(steps, 1, "cuda")
    kernels = [event for event in watched.events() if event.device_type.name == "CUDA"]
    return {
        "kernels": len(kernels),
        "busy_ms": sum(kernel.self_device_time_total for kernel in kernels) / 1e3,
        "memory_gib": torch.cuda.max_memory_allocated() / 2**30,
    }


def compared(*runs: Path) -> dict[str, Any]:
    """Return how many trials of an audit end alike on both devices, and the successes of both."""
    columns = ["variant", "path", "seed", "scene", "status"]
    rows = [pq.read_table(run / "outcomes.parquet", columns=columns).to_pylist() for run in runs]
    ends = [{tuple(row.values())[:-1]: row["status"] for row in trials} for trials in rows]
    assert ends[0].keys() == ends[1].keys(), "the runs do not hold the same trials"
    return {
        "trials": len(ends[0]),
        "alike": sum(ends[0][trial] == ends[1][trial] for trial in ends[0]),
        "successes": [sum(end == "success" for end in ended.values()) for ended in ends],
    }


if __name__ == "__main__":
    main()
