"""Measure the baselines of one platform on the selection library; run by `search.py`.

    python measure.py JOB.json FOLDER

The platform is set before anything that flies is imported: one process, one platform.
"""

import hashlib
import json
import shutil
import sys
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import faultpath_quadrotor.platform as chosen
from faultpath_quadrotor.predictors import anchored, compiled
from space import platform_of

JOB: dict[str, Any] = json.loads(Path(sys.argv[1]).read_text())
FOLDER = Path(sys.argv[2])
MEASURED_SEEDS: list[int] = JOB["seeds"]
POINT: dict[str, Any] = JOB["point"]
PLATFORM = chosen.PLATFORM = platform_of(POINT)
anchored.LINEAR_BOUND_MPS2 = compiled.LINEAR_BOUND_MPS2 = POINT["residual_bound_mps2"]

import numpy as np  # noqa: E402  (the platform first)
import torch  # noqa: E402
from faultpath_paper.evidence.inputs import Subject  # noqa: E402
from faultpath_paper.evidence.quantities import _QUANTITIES as QUANTITIES  # noqa: E402
from faultpath_paper.evidence.recording import STRIDE  # noqa: E402
from faultpath_paper.evidence.table import Measurement, Recording  # noqa: E402
from faultpath_quadrotor import checkpoint, native  # noqa: E402
from faultpath_quadrotor.device import CPU, arithmetic  # noqa: E402
from faultpath_quadrotor.plant.module import ACTION  # noqa: E402
from faultpath_quadrotor.plant.world import CONTROL_STEPS  # noqa: E402
from faultpath_quadrotor.system import Quadrotor  # noqa: E402
from faultpath_quadrotor.training import predictor_task, recorded  # noqa: E402
from faultpath_quadrotor.training.collection import collect  # noqa: E402
from faultpath_quadrotor.training.fitting import fit  # noqa: E402
from faultpath_quadrotor.training.pool import (  # noqa: E402
    FlightData,
    encode_episodes,
    encode_rows,
)
from faultpath_quadrotor.training.predictor_task import PredictorTask  # noqa: E402
from faultpath_quadrotor.training.reconstruction_task import (  # noqa: E402
    MODELS,
    ReconstructionTask,
)
from faultpath_quadrotor.training.windows import cut, places  # noqa: E402

from faultpath import loop  # noqa: E402
from faultpath.faults import resolve  # noqa: E402
from faultpath.loop import Taps  # noqa: E402
from faultpath.trials.store import atomic  # noqa: E402


def decisive(name: str) -> list[object]:
    """Return what decides a model: of one fitted in still air alone, not the winds."""
    flown = PLATFORM.model_dump(mode="json", include={"drag_kgps", "ranges", "collection"})
    decides: list[object] = [flown]
    if name in ("wm-u", "wm-u+dcc"):
        return [*decides, POINT["conditioning_scale"]]
    if name.startswith("wm-a"):
        decides.append(POINT["residual_bound_mps2"])
    if name not in ("wm-a", "wm-a+dcc"):
        winds = PLATFORM.winds.model_dump(mode="json", exclude={"means_mps"})
        windy = PLATFORM.model_dump(mode="json", include={"wind_collection"})
        decides += [winds, windy, POINT["pool_turbulence_mps"]]
    return decides


OWN_HASH = chosen.Platform.weights_hash
chosen.Platform.weights_hash = lambda self, model: (
    OWN_HASH(self, model) if model == chosen.CLEARANCE else digest(*decisive(model))[:16]
)


def weights(names: list[str], seeds: list[int]) -> Path:
    """Fit what no point has fitted yet and return the folder of this point's weights."""
    data = FOLDER / "pools" / digest(*decisive("gru"))
    folder = FOLDER / "weights" / digest(*[decisive(name) for name in names])
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("clearance-0.json", "clearance-0.safetensors"):
        shutil.copy(checkpoint.shipped_folder() / name, folder)
    for name in names:
        place = FOLDER / "models" / digest(name, *decisive(name))
        place.mkdir(parents=True, exist_ok=True)
        for seed in seeds:
            with atomic.locked(place, print):
                if not (place / f"{name}-{seed}.json").exists():
                    data.mkdir(parents=True, exist_ok=True)
                    with atomic.locked(data, print):
                        collect(data / "rows", workers=0)
                    began = time.monotonic()
                    task = ReconstructionTask if name in MODELS else PredictorTask
                    with native.using(native.PORTABLE):
                        fit(task(name, seed, data / "rows"), place)
                    print(f"fitted {name}-{seed} in {time.monotonic() - began:.0f} s", flush=True)
            for suffix in (".json", ".safetensors"):
                shutil.copy(place / f"{name}-{seed}{suffix}", folder)
    return folder


def digest(*content: object) -> str:
    """Return a short hash of what decides something."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:24]


def scaled_statistics(measure: Any) -> Any:
    """Return the statistics of features with those of the calibration scaled."""

    def scaled(network: Any, windows: Any) -> None:
        measure(network, windows)
        if network.conditioned:
            network.feature_std[-2:] *= POINT["conditioning_scale"]

    return scaled


predictor_task._measure = scaled_statistics(predictor_task._measure)


def flight_key(cell: dict[str, Any], seed: int, first: int, last: int) -> str:
    """Return a hash of what decides the flights of a cell and what is measured on them."""
    beside = ["residual_bound_mps2", "pool_turbulence_mps", "elevation_deg"]
    beside += ["conditioning_scale"] if "wm-u" in json.dumps(cell) else []
    more = [POINT[name] for name in beside]
    return digest(PLATFORM.hash, more, JOB["code"], cell, seed, first, last, MEASURED_SEEDS)


@arithmetic()
@torch.inference_mode()
def fly(cell: dict[str, Any], seed: int, first: int, last: int) -> dict[str, Any]:
    """Return how scenes of a cell ended, and each measured model's errors by window."""
    place = FOLDER / "flights" / f"{flight_key(cell, seed, first, last)}.json"
    if place.exists():
        return json.loads(place.read_text())
    system = Quadrotor.parse(**cell["options"])
    scenes = tuple(s.id for s in system.library("selection").scenes[first:last])
    wired = system.variants[cell["variant"]]
    faults = [system.fault(cell["fault"])] if cell.get("fault") else []
    taps = Taps(
        system.interface,
        resolve(faults, system.interface, wired.consumers),
        scenes=scenes,
        dt_s=system.control_dt_s,
        seed=seed,
        bindings=wired.bindings,
        consumers=wired.consumers,
        privileged=wired.privileged,
    )
    values = recorded.blank_values(CONTROL_STEPS, len(scenes))
    batch, world = loop.Batch(scenes, seed, system.control_dt_s), None
    for now in system.loop(cell["variant"], seed).execute(batch, taps):
        world = now.state.world
        command = now.inputs[ACTION].T[:, world.lanes] if ACTION in now.inputs else None
        recorded.record(values, now.step, world.plant_state, world.wind_mps, command)
    ended, count = world.progress.to(CPU), len(scenes)
    steps = np.floor(ended.time_s.numpy()[:count] * 20 + 1e-6).astype(np.int64)
    flights = recorded.Flights(values, steps, tuple(system.scene(s).vehicle for s in scenes))
    pool = FlightData.decode(
        "search", encode_rows(range(count), flights), encode_episodes(range(count), flights)
    )
    at = places(pool, STRIDE)
    found: dict[str, Any] = {}
    if cell.get("measured") and len(at) and seed == 0:
        windows = cut(pool, STRIDE)
        for label, (quantity, subject, *errors) in cell["measured"].items():
            recording = Recording(library="selection", variant=cell["variant"])
            for trained in MEASURED_SEEDS if label == "gru" else [0]:
                question = Measurement(
                    recording=recording, quantity=quantity, subject=subject, faults=tuple(errors)
                )
                error = QUANTITIES[quantity](
                    Subject.load(system, subject, trained), question, windows
                )
                found[label + (f"-{trained}" if trained else "")] = [
                    [int(s) + first for s in at[:, 0]],
                    [round(e, 5) for e in error.tolist()],
                ]
    status = [
        "crash" if c else "success" if s else "timeout"
        for c, s in zip(
            ended.crashed[:count].tolist(), ended.succeeded[:count].tolist(), strict=True
        )
    ]
    result = {
        "status": status,
        "time_s": [round(t, 4) for t in ended.time_s[:count].tolist()],
        "errors": found,
        "first": first,
    }
    place.parent.mkdir(exist_ok=True, parents=True)
    atomic.write(place, json.dumps(result).encode())
    return result


def main() -> None:
    """Fit, fly, and write what was found beside the job."""
    torch.set_num_threads(1)
    folder = weights(JOB["fitted"], JOB["seeds"])
    checkpoint.shipped_folder = lambda: folder
    found = {}
    bounds = JOB["bounds"]
    for name, cell in JOB["cells"].items():
        seeds = JOB["seeds"] if cell.get("seeds") else JOB["seeds"][:1]
        found[name] = [fly(cell, seed, a, b) for seed in seeds for a, b in pairwise(bounds)]
        print(name, flush=True)
    atomic.write(Path(sys.argv[1]).with_suffix(".found.json"), json.dumps(found).encode())


if __name__ == "__main__":
    main()
