"""What is fitted, flown and measured where reconstructions err more, in one process each."""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import torch

import faultpath
from faultpath.evidence import Measurement
from faultpath.quadrotor import native
from faultpath.quadrotor.checkpoint import shipped_folder
from faultpath.quadrotor.device import arithmetic
from faultpath.quadrotor.evidence.inputs import Subject
from faultpath.quadrotor.evidence.measuring import measure
from faultpath.quadrotor.evidence.quantities import of_windows
from faultpath.quadrotor.evidence.recording import STRIDE
from faultpath.quadrotor.options import QuadrotorOptions
from faultpath.quadrotor.plant import wind
from faultpath.quadrotor.platforms import DEFAULT
from faultpath.quadrotor.system import Quadrotor
from faultpath.quadrotor.training.closed_loop import record_flights
from faultpath.quadrotor.training.collection import collect
from faultpath.quadrotor.training.fitting import fit
from faultpath.quadrotor.training.pool import FlightData, encode_episodes, encode_rows
from faultpath.quadrotor.training.predictor_task import PredictorTask
from faultpath.quadrotor.training.reconstruction_task import MODELS, ReconstructionTask
from faultpath.quadrotor.training.windows import Windows, cut
from faultpath.studies.cells import SELECTION, Cell, Setting
from faultpath.studies.pages.table_1 import recording
from faultpath.studies.pages.table_4 import NAMES
from faultpath.studies.pages.table_6 import INTERFACES
from faultpath.studies.pages.table_6 import seeds as of

SEEDS = (0, 1, 2)
FITTED = (("wm-a-wind", 0), *((name, seed) for name in ("gru", "gru+dcc") for seed in SEEDS))
"""Models that see wind in training; the predictor is that of seed 0, as in the paper."""
WINDY = Setting(library=SELECTION, wind="L3")
FAULT = "calibration=+0.1"


@contextmanager
def unsteady(times: float) -> Iterator[None]:
    """Have turbulence and gusts so many times stronger beside the same sustained wind."""
    turbulence, gust = wind.TURBULENCE_OVER_MEAN, wind.GUST_OVER_MEAN
    wind.TURBULENCE_OVER_MEAN = times * turbulence
    wind.GUST_OVER_MEAN = (times * gust[0], times * gust[1])
    try:
        yield
    finally:
        wind.TURBULENCE_OVER_MEAN, wind.GUST_OVER_MEAN = turbulence, gust


def observer_error(times: float, folder: Path) -> float:
    """Return the median acceleration error of the observer under correct inputs, m/s^2.

    As in Table VI (a), but on windows that were flown with the observer itself, which learns
    nothing: no trained reconstruction is looked at.
    """
    asked = Measurement(
        recording=recording(Cell(WINDY, "dob")), quantity="acceleration-error", subject="dob"
    )
    with unsteady(times):
        found = measure([asked], None, folder / f"windows-{times:g}")
    return float(np.median(found.values(asked).values))


def pools(times: float, names: tuple[str, ...], windy: int | None, folder: Path) -> Path:
    """Collect training flights, so many of them in wind, and return their folder."""
    with unsteady(times):
        collect(folder, names, workers=0, episodes=None if windy is None else {"wind": windy})
    return folder


def fitted(times: float, name: str, seed: int, data: Path, folder: Path) -> None:
    """Fit one model on these flights."""
    with unsteady(times), native.using(native.PORTABLE):  # as every fit
        task = ReconstructionTask if name in MODELS else PredictorTask
        fit(task(name, seed, data), folder)


def completed(folder: Path) -> None:
    """Add the shipped models that fly beside those that were fitted."""
    for model in ("clearance-0", "wm-a-wind-0"):
        for file in shipped_folder().glob(f"{model}.*"):
            if not (folder / file.name).exists():
                shutil.copy(file, folder)


def poor(windy: int, folder: Path) -> float:
    """Fit a GRU on so many flights in wind; return its acceleration error under correct inputs.

    In the wind as it is frozen, as in Table VI (a), m/s^2.
    """
    data = pools(1.0, ("wind",), windy, folder / f"data-{windy}")
    models = folder / f"models-{windy}"
    fitted(1.0, "gru", 0, data, models)
    completed(models)
    system = _system(models)
    with arithmetic(), torch.inference_mode():
        return _error(system, "gru", (), 0, _windows(_system(None)))


def _system(models: Path | None) -> Quadrotor:
    chosen = QuadrotorOptions.parse(**WINDY.options)
    return Quadrotor(chosen.model_copy(update={"settings": DEFAULT, "checkpoints": models}))


def acceleration_errors(times: float, models: Path | None) -> dict[str, dict[str, float]]:
    """Return the errors of Table VI (a), m/s^2, by reconstruction and by where the error strikes.

    On windows of flights with the GRU of seed 0; means over seeds of medians over windows.
    """
    system = _system(models)
    with unsteady(times), arithmetic(), torch.inference_mode():
        windows = _windows(system)
        return {
            method: {
                interface: float(
                    np.mean([_error(system, method, faults, seed, windows) for seed in of(method)])
                )
                for interface, faults in INTERFACES.items()
            }
            for method in NAMES
        }


def _windows(system: Quadrotor) -> Windows:
    scenes = [scene.id for scene in system.library(SELECTION).scenes]
    flights, count = record_flights(system, "gru", scenes, 0), range(len(scenes))
    rows, episodes = encode_rows(count, flights), encode_episodes(count, flights)
    return cut(FlightData.decode("selection", rows, episodes), STRIDE)


def _error(
    system: Quadrotor, method: str, faults: tuple[str, ...], seed: int, windows: Windows
) -> float:
    asked = Measurement(
        recording=recording(Cell(WINDY, "gru")),
        quantity="acceleration-error",
        subject=method,
        seed=seed,
        faults=faults,
    )
    return float(of_windows(Subject.load(system, method, seed), asked, windows).median())


def audited(
    condition: tuple[float, Path | None],
    arms: tuple[str, str],
    seeds: Sequence[int],
    library: str,
    folder: Path,
) -> None:
    """Audit the second arm against the first, in a wind and with the models, into a folder."""
    times, models = condition
    with unsteady(times):
        faultpath.audit(
            _system(models),
            baseline=arms[0],
            repair=arms[1],
            fault=FAULT,
            library=library,
            seeds=seeds,
            folder=folder,
            workers=0,
            progress=False,
        )
