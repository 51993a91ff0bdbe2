"""Measures one platform on one rung of the search: fits what it needs, flies, and judges."""

import fcntl
import shutil
import time
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from platform_judged import judged
from platform_matched import CELLS, Flyer, Quantity, quantities

from faultpath.quadrotor import native
from faultpath.quadrotor.checkpoint import shipped_folder
from faultpath.quadrotor.platform import Platform
from faultpath.quadrotor.platforms import FIRST
from faultpath.quadrotor.training.collection import collect
from faultpath.quadrotor.training.fitting import fit
from faultpath.quadrotor.training.predictor_task import PredictorTask


@dataclass(frozen=True)
class Rung:
    """So many scenes, with so many of the learned models fitted."""

    scenes: int
    fitted: tuple[str, ...]


RUNGS = (Rung(20, ()), Rung(50, ("wm-a",)), Rung(100, ("wm-a", "wm-a-wind")))
"""A lower rung costs less: nothing is fitted for the first, and the model that is told the wind
takes longest. What is not fitted has the model with true parameters standing in for it."""
SEEDS = (0, 1, 2)
WIND_EPISODES = 7150
"""As many as in still air: of the larger pool the mix would use no more windows."""


@dataclass(frozen=True)
class Measurer:
    """Keeps what it fitted and flew in a folder, by content; several may share one."""

    folder: Path
    code: str
    """Hash of the code that fits and flies."""

    def measure(self, platform: Platform, rung: int, seeds: Sequence[int]) -> dict[str, Any]:
        """Return the quantities of a platform on a rung, their distance and the time it took."""
        started = time.monotonic()
        asked = quantities(RUNGS[rung].fitted)
        models = self._models(platform, RUNGS[rung].fitted, seeds)
        (self.folder / "flights").mkdir(exist_ok=True)
        flyer = Flyer(platform, models, self.folder / "flights", self.code)
        bounds = (0, *(each.scenes for each in RUNGS[: rung + 1]))
        flown = {
            cell: [
                flyer.block(cell, _measured(asked, cell), seed, first, last)
                for seed in (seeds if _over_seeds(cell) else seeds[:1])
                for first, last in pairwise(bounds)
            ]
            for cell in {quantity.cell: None for quantity in asked}
        }
        return {**judged(asked, flown), "seconds": round(time.monotonic() - started)}

    def _models(self, platform: Platform, names: Collection[str], seeds: Sequence[int]) -> Path:
        if platform == FIRST:
            return shipped_folder()
        folder = self.folder / "models" / f"{platform.weights_hash('wm-a')}-{self.code[:12]}"
        folder.mkdir(parents=True, exist_ok=True)
        with _alone(folder):
            missing = [
                (name, seed)
                for name in names
                for seed in seeds
                if not (folder / f"{name}-{seed}.json").exists()
            ]
            for file in shipped_folder().glob("clearance-0.*"):
                shutil.copy(file, folder)
            data = folder / "data"
            if missing:
                pools = ("nominal", "wind") if "wm-a-wind" in dict(missing) else ("nominal",)
                collect(data, pools, 0, {"wind": WIND_EPISODES}, platform=platform)
            for name, seed in missing:
                with native.using(native.PORTABLE):  # as every fit
                    fit(PredictorTask(name, seed, data, platform=platform), folder)
            shutil.rmtree(data, ignore_errors=True)
        return folder


def _over_seeds(cell: str) -> bool:
    """Say whether the paper averages a cell over seeds."""
    return bool(CELLS[cell].error) or cell == "zero wind, L3, free space"


def _measured(asked: Sequence[Quantity], cell: str) -> list[tuple[str, float]]:
    return sorted({each.model for each in asked if each.cell == cell and each.model[0]})


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    with (folder / ".lock").open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
