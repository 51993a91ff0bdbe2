"""The quantities that the platform search matches, and what is flown for them.

All are baselines on the selection library.
"""

import hashlib
import json
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import torch

from faultpath.faults import Coupled, parse_fault
from faultpath.quadrotor.device import arithmetic
from faultpath.quadrotor.evidence.recording import STRIDE
from faultpath.quadrotor.models import Shelf, predictor
from faultpath.quadrotor.options import QuadrotorOptions
from faultpath.quadrotor.platform import Platform
from faultpath.quadrotor.system import Quadrotor
from faultpath.quadrotor.training.closed_loop import fly_recorded
from faultpath.quadrotor.training.pool import FlightData, encode_episodes, encode_rows
from faultpath.quadrotor.training.quality_rows import position_errors
from faultpath.quadrotor.training.windows import cut, places
from faultpath.store import atomic
from faultpath.studies.published import published

LIBRARY = "selection"
COMMON = "true-parameter"
"""The cell whose flights are the common trajectories."""

_TRUE = {"clearance": "true"}
_ZERO = "zero-wind"


@dataclass(frozen=True)
class Cell:
    """One arm."""

    predictor: str
    wind: str = "L0"
    options: dict[str, str] = field(default_factory=dict)
    error: str = ""
    """Calibration error of all that read it, as in a fault's text."""

    @property
    def variant(self) -> str:
        """Return the name of what flies."""
        return self.predictor if self.wind == "L0" else f"{self.predictor}/{_ZERO}"


def _cells() -> dict[str, Cell]:
    found = {
        "DKI": Cell("dki"),
        "WM-A": Cell("wm-a"),
        COMMON: Cell("true-parameter"),
        "WM-A, true clearance": Cell("wm-a", options=_TRUE),
        "true-parameter, true clearance": Cell("true-parameter", options=_TRUE),
    }
    for sign in "+-":
        found[f"WM-A, e = {sign}0.1"] = Cell("wm-a", error=f"{sign}0.1")
    for level in ("L2", "L3"):
        found[f"zero wind, {level}"] = Cell("wm-a-wind", level)
        found[f"zero wind, {level}, free space"] = Cell(
            "wm-a-wind", level, {"environment": "free-space"}
        )
    return found


PAPER_CELLS = _cells()
STAND_INS = {
    f"{COMMON} for {name}": replace(cell, predictor="true-parameter")
    for name, cell in PAPER_CELLS.items()
    if cell.error or cell.wind == "L3"
}
"""What is flown on the lower rungs, where the learned model is not fitted yet; L2 can wait."""
CELLS = PAPER_CELLS | STAND_INS


@dataclass(frozen=True)
class Quantity:
    """Something that the paper prints of a baseline."""

    group: str
    name: str
    cell: str
    kind: str
    """`success` and `crash` are shares, `time` in s, `error` a median in m."""
    target: float
    model: tuple[str, float] = ("", 0.0)
    """Of an error: the model and the calibration error it is given."""

    @property
    def needs(self) -> frozenset[str]:
        """Return which predictors are flown and measured for it."""
        return frozenset({CELLS[self.cell].predictor, self.model[0]} - {""})


def _quantities() -> Iterator[Quantity]:
    rows = {  # of Table I, by cell
        "DKI": ("DKI", "dki"),
        "WM-A": ("WM-A", "wm-a"),
        COMMON: ("true-parameter", "true-parameter"),
        "WM-A, true clearance": ("WM-A/true-clearance", "wm-a"),
        "true-parameter, true clearance": (
            "true-parameter/true-clearance",
            "true-parameter",
        ),
    }
    table_1 = partial(published, "table_1_prediction_accuracy")
    for cell in ("DKI", "WM-A"):
        row, model = rows[cell]
        error = table_1(row, "error_common_cm") / 100
        yield Quantity("accuracy", f"common error, {cell}", COMMON, "error", error, (model, 0.0))
    for cell, (row, model) in rows.items():
        error = table_1(row, "error_own_cm") / 100
        yield Quantity("accuracy", f"own error, {cell}", cell, "error", error, (model, 0.0))
    for kind in ("success", "crash"):
        for cell, (row, _) in rows.items():
            yield Quantity("outcomes", f"{kind}, {cell}", cell, kind, table_1(row, kind) / 100)
    for cell, (row, _) in rows.items():
        yield Quantity("times", f"time, {cell}", cell, "time", table_1(row, "time_s"))
    table_2 = partial(published, "table_2_calibration")
    for sign, place in (("+", 2), ("-", 0)):
        cell = f"WM-A, e = {sign}0.1"
        success = table_2("WM-A", place) / 100
        yield Quantity("calibration", f"success, {cell}", cell, "success", success)
        error = table_2("WM-A_seed0", "error_cm", place) / 100
        model = ("wm-a", float(f"{sign}0.1"))
        yield Quantity("calibration", f"common error, {cell}", COMMON, "error", error, model)
    for environment, row in (("obstacles", ""), ("free_space", ", free space")):
        for place, level in ((1, "L2"), (2, "L3")):
            cell = f"zero wind, {level}{row}"
            share = published("table_3_wind", environment, "wind-conditioned/zero", place) / 100
            yield Quantity("wind", f"success, {cell}", cell, "success", share)


QUANTITIES = tuple(_quantities())


def quantities(fitted: Collection[str]) -> tuple[Quantity, ...]:
    """Return what can be asked of a platform for which so many of the learned models are fitted.

    Of what faults and wind cost, the model with true parameters stands in for one that is not.
    """
    known = {"dki", "true-parameter", *fitted}
    found: list[Quantity] = []
    for each in QUANTITIES:
        if each.needs <= known:
            found.append(each)
        elif each.kind == "error" and each.model[1]:
            found.append(replace(each, model=("true-parameter", each.model[1])))
        elif f"{COMMON} for {each.cell}" in STAND_INS:
            found.append(replace(each, cell=f"{COMMON} for {each.cell}"))
    return tuple(found)


@dataclass(frozen=True)
class Flyer:
    """Flies cells of a platform and keeps what came of each block of scenes."""

    platform: Platform
    models: Path
    kept: Path
    code: str
    """Hash of the code that flies."""

    def block(
        self,
        cell: str,
        models: Sequence[tuple[str, float]],
        seed: int,
        first: int,
        last: int,
    ) -> dict[str, Any]:
        """Return how scenes `first` to `last` ended and by how much models were off, flown once."""
        what = CELLS[cell]
        content = [self.platform.hash, self.code, repr(what), models, seed, first, last]
        name = hashlib.sha256(json.dumps(content).encode()).hexdigest()[:24]
        path = self.kept / f"{name}.json"
        if not path.exists():
            found = self._fly(what, models, seed, first, last)
            atomic.write(path, json.dumps(found).encode())
        return json.loads(path.read_text())

    def _fly(
        self, cell: Cell, models: Sequence[tuple[str, float]], seed: int, first: int, last: int
    ) -> dict[str, Any]:
        chosen = QuadrotorOptions.parse(wind=cell.wind, **cell.options)
        update = {"settings": self.platform, "checkpoints": self.models}
        system = Quadrotor(chosen.model_copy(update=update))
        scenes = [scene.id for scene in system.library(LIBRARY).scenes[first:last]]
        faults = ()
        if cell.error:
            text = f"calibration={cell.error}"
            fault = parse_fault(text, system.interface, system.fault_presets, system.control_dt_s)
            assert isinstance(fault, Coupled)
            faults = (fault,)
        with arithmetic():
            flights, ended = fly_recorded(system, cell.variant, scenes, seed, faults)
            count = range(len(scenes))
            data = FlightData.decode(
                "search", encode_rows(count, flights), encode_episodes(count, flights)
            )
            found = self._measured(models, seed, data, first)
        status = ["crash" if crashed else "timeout" for crashed in ended.crashed[: len(scenes)]]
        for place, succeeded in enumerate(ended.succeeded[: len(scenes)].tolist()):
            if succeeded:
                status[place] = "success"
        return {
            "status": status,
            "time_s": [round(time, 4) for time in ended.time_s[: len(scenes)].tolist()],
            "errors": found,
        }

    @torch.inference_mode()
    def _measured(
        self, models: Sequence[tuple[str, float]], seed: int, data: FlightData, first: int
    ) -> list[dict[str, Any]]:
        place = places(data, STRIDE)
        if not models or not len(place):
            return []
        windows, shelf = cut(data, STRIDE), Shelf(self.platform, self.models)
        scenes = (place[:, 0] + first).tolist()
        return [
            {
                "model": model,
                "error": error,
                "scenes": scenes,
                "missed_m": [
                    round(each, 5)
                    for each in position_errors(
                        predictor(model, seed, shelf=shelf), windows, error
                    )[-1].tolist()
                ],
            }
            for model, error in models
        ]
