"""Time flights on this machine's processor and on its GPU; `device.json` keeps the figures.

python -m benchmarks.device                          time control steps, on a machine with a GPU
python -m benchmarks.device --paper                  time a table of the paper there too, 10 minutes
python -m benchmarks.device --audits CPU_RUN GPU_RUN compare one audit, flown on both

Each part of the file names the command that measured it.

One process on one core flies blocks of 50 scenes with the fastest kernels, as a worker of an audit
does; one process feeds the GPU blocks of 100 scenes, as `--device cuda` does, and of 200. They take
turns, and all fly the GRU in the strongest wind with the model of depth, in scenes on which nothing
is decided. The first steps, in which libraries load, are not counted.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pyarrow.parquet as pq
import torch
from faultpath_quadrotor import native
from faultpath_quadrotor.device import arithmetic
from faultpath_quadrotor.system import Quadrotor
from torch.profiler import ProfilerActivity, profile

from benchmarks.results import DEVICE
from faultpath import open_run
from faultpath.loop import Batch
from faultpath.run.attempt import taps_of
from faultpath.run.plan import SystemSpec, Treatment
from faultpath.run.registry import load_system

FLOWN = {"predictor": "wm-a-wind", "clearance": "depth", "wind": "L3"}
LIBRARIES = "training", "selection"
BLOCKS = (("cpu", 50), ("cuda", 100), ("cuda", 200))
VARIANT, WARM_UP, ROUNDS, STEPS = "gru", 5, 7, 4
PAGE = "table-4"
COMMAND = "python -m benchmarks.device"


def main() -> None:
    parser = argparse.ArgumentParser(prog=COMMAND.removeprefix("python -m "))
    parser.add_argument("--audits", nargs=2, type=Path, metavar=("CPU_RUN", "GPU_RUN"))
    parser.add_argument("--paper", action="store_true", help=f"fly {PAGE} on both devices")
    parser.add_argument("--out", type=Path, default=DEVICE, help="the JSON file of the figures")
    options = parser.parse_args()
    figures = json.loads(options.out.read_text()) if options.out.is_file() else {}
    if not torch.cuda.is_available():
        parser.error("there is no GPU here: run it on a machine that has one")
    mine = figures.setdefault(torch.cuda.get_device_name(), {})
    if options.audits:
        mine["audits"] = compared(*options.audits)
    elif options.paper:
        mine["paper"] = paper()
    else:
        mine |= steps()
    options.out.write_text(json.dumps(figures, indent=1) + "\n")
    print(options.out.read_text())


def steps() -> dict[str, Any]:
    """Return what control steps take on each device, ms, round by round."""
    kernels, sides = native.kernels(), [_flying(*block) for block in BLOCKS]
    times: list[list[float]] = [[] for _ in sides]
    with torch.no_grad(), arithmetic():
        for flying in sides:
            _step(flying, WARM_UP)
        for _ in range(ROUNDS):
            for flying, taken in zip(sides, times, strict=True):
                begun = time.perf_counter()
                _step(flying, STEPS)
                taken.append((time.perf_counter() - begun) / STEPS * 1e3)
        rest = [
            _profiled(flying) if device == "cuda" else {}
            for flying, (device, _) in zip(sides, BLOCKS, strict=True)
        ]
    return {
        "command": COMMAND,
        "torch": torch.__version__,
        "kernels": native.PORTABLE if kernels is None else kernels.isa,
        "date": datetime.now(UTC).date().isoformat(),
        "steps": [
            {"device": device, "scenes": size, "step_ms": taken, **more}
            for (device, size), taken, more in zip(BLOCKS, times, rest, strict=True)
        ],
    }


def paper() -> dict[str, Any]:
    """Return what a table of the paper takes in its size, with every core and on the GPU, s."""
    cores = len(os.sched_getaffinity(0))
    figures: dict[str, Any] = {
        "command": f"{COMMAND} --paper",
        "runs": f"faultpath reproduce {PAGE} --profile paper",
        "cores": cores,
    }
    command = (sys.executable, "-m", *figures["runs"].split())
    for name, options in (("cpu_s", ("--workers", str(cores))), ("gpu_s", ("--device", "cuda"))):
        with TemporaryDirectory() as folder:
            begun = time.perf_counter()
            subprocess.run((*command, *options, "--out", folder), check=True)
            figures[name] = time.perf_counter() - begun
            figures["trials"] = pq.read_metadata(Path(folder, PAGE, "outcomes.parquet")).num_rows
    return figures


def _flying(device: str, size: int) -> Iterator[Any]:
    built = load_system(SystemSpec(name="quadrotor", options={**FLOWN, "device": device}))
    assert isinstance(built, Quadrotor)
    every = (scene.id for name in LIBRARIES for scene in built.library(name).scenes)
    scenes = tuple(islice(every, size))
    taps = taps_of(built, Treatment(variant=VARIANT, faults=()), scenes)
    return built.loop(VARIANT, seed=0).execute(Batch(scenes, 0, built.control_dt_s), taps)


def _step(steps: Iterator[Any], count: int) -> None:
    for _ in range(count):
        next(steps)
    torch.cuda.synchronize()


def _profiled(steps: Iterator[Any]) -> dict[str, float]:
    """Return the kernels of one control step, and how long they compute."""
    both = [ProfilerActivity.CUDA, ProfilerActivity.CPU]
    with profile(activities=both, acc_events=True) as watched:
        _step(steps, 1)
    kernels = [event for event in watched.events() if event.device_type.name == "CUDA"]
    return {
        "kernels": len(kernels),
        "busy_ms": sum(kernel.self_device_time_total for kernel in kernels) / 1e3,
    }


def compared(*folders: Path) -> dict[str, Any]:
    """Return how many trials and decisions of an audit are alike on both devices."""
    runs = [open_run(folder) for folder in folders]
    ends = [
        {
            (row["variant"], row["condition"], row["seed"], row["scene"]): row["status"]
            for row in rows
        }
        for rows in (run.table().to_pylist() for run in runs)
    ]
    assert ends[0].keys() == ends[1].keys(), "the runs do not hold the same trials"
    signs = [[effect.sign for effect in run.record.effects] for run in runs]
    return {
        "command": f"{COMMAND} --audits CPU_RUN GPU_RUN",
        "trials": len(ends[0]),
        "alike": sum(ends[0][trial] == ends[1][trial] for trial in ends[0]),
        "successes": [sum(end == "success" for end in ended.values()) for ended in ends],
        "conditions": len(signs[0]),
        "decided_alike": sum(one == other for one, other in zip(*signs, strict=True)),
    }


if __name__ == "__main__":
    main()
