"""The quantities that the platform search matches, and what is flown for them.

All are baselines on the selection library.
"""

import hashlib
import json
from dataclasses import dataclass, field
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

LIBRARY = "selection"

_TRUE = {"clearance": "true"}
_L2, _L3 = {"wind": "L2"}, {"wind": "L3"}
_FREE = {"environment": "free-space"}
ZERO = "wm-a-wind/zero-wind"


@dataclass(frozen=True)
class Cell:
    """One arm: what flies, and which models are measured on its windows, each under which error."""

    variant: str
    options: dict[str, str] = field(default_factory=dict)
    fault: str | None = None
    measured: tuple[tuple[str, float], ...] = ()


CELLS = {
    "DKI": Cell("dki", measured=(("dki", 0.0),)),
    "WM-A": Cell("wm-a", measured=(("wm-a", 0.0),)),
    "true-parameter": Cell(
        "true-parameter",
        measured=(
            ("true-parameter", 0.0),
            ("dki", 0.0),
            ("wm-a", 0.0),
            ("wm-a", 0.1),
            ("wm-a", -0.1),
        ),
    ),
    "WM-A, true clearance": Cell("wm-a", _TRUE, measured=(("wm-a", 0.0),)),
    "true-parameter, true clearance": Cell(
        "true-parameter", _TRUE, measured=(("true-parameter", 0.0),)
    ),
    "WM-A, e = +0.1": Cell("wm-a", fault="calibration=+0.1"),
    "WM-A, e = -0.1": Cell("wm-a", fault="calibration=-0.1"),
    "zero wind, L2": Cell(ZERO, _L2),
    "zero wind, L3": Cell(ZERO, _L3),
    "zero wind, L2, free space": Cell(ZERO, _L2 | _FREE),
    "zero wind, L3, free space": Cell(ZERO, _L3 | _FREE),
}


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


def _quantities() -> tuple[Quantity, ...]:
    table_1 = {  # success, crash, median time
        "DKI": (0.68, 0.13, 4.25),
        "WM-A": (0.69, 0.21, 2.75),
        "true-parameter": (0.69, 0.16, 3.20),
        "WM-A, true clearance": (0.73, 0.04, 2.50),
        "true-parameter, true clearance": (0.74, 0.04, 2.95),
    }
    common = "true-parameter"
    own = {
        "DKI": ("dki", 0.310),
        "WM-A": ("wm-a", 0.095),
        "true-parameter": ("true-parameter", 0.026),
        "WM-A, true clearance": ("wm-a", 0.073),
        "true-parameter, true clearance": ("true-parameter", 0.006),
    }
    found = [
        Quantity("accuracy", f"common error, {name}", common, "error", target, (model, 0.0))
        for name, model, target in (("DKI", "dki", 0.328), ("WM-A", "wm-a", 0.082))
    ]
    found += [
        Quantity("accuracy", f"own error, {name}", name, "error", target, (model, 0.0))
        for name, (model, target) in own.items()
    ]
    for kind, place in (("success", 0), ("crash", 1), ("time", 2)):
        group = "times" if kind == "time" else "outcomes"
        found += [
            Quantity(group, f"{kind}, {name}", name, kind, row[place])
            for name, row in table_1.items()
        ]
    for sign, error, success, missed in (("+", 0.1, 0.08, 0.610), ("-", -0.1, 0.18, 0.747)):
        name = f"WM-A, e = {sign}0.1"
        found.append(Quantity("calibration", f"success, {name}", name, "success", success))
        found.append(
            Quantity(
                "calibration", f"common error, {name}", common, "error", missed, ("wm-a", error)
            )
        )
    found += [
        Quantity("wind", f"success, {name}", name, "success", target)
        for name, target in (
            ("zero wind, L2", 0.60),
            ("zero wind, L3", 0.39),
            ("zero wind, L2, free space", 0.96),
            ("zero wind, L3, free space", 0.787),
        )
    ]
    return tuple(found)


QUANTITIES = _quantities()


@dataclass(frozen=True)
class Flyer:
    """Flies cells of a platform and keeps what came of each block of scenes."""

    platform: Platform
    models: Path
    kept: Path
    code: str
    """Hash of the code that flies."""

    def block(self, cell: str, seed: int, first: int, last: int) -> dict[str, Any]:
        """Return how scenes `first` to `last` ended and by how much models were off, flown once."""
        what = CELLS[cell]
        content = [self.platform.hash, self.code, cell, repr(what), seed, first, last]
        name = hashlib.sha256(json.dumps(content).encode()).hexdigest()[:24]
        path = self.kept / f"{name}.json"
        if not path.exists():
            part = path.with_suffix(".part")
            part.write_text(json.dumps(self._fly(what, seed, first, last)))
            part.replace(path)
        return json.loads(path.read_text())

    def _fly(self, cell: Cell, seed: int, first: int, last: int) -> dict[str, Any]:
        chosen = QuadrotorOptions.parse(**cell.options)
        update = {"settings": self.platform, "checkpoints": self.models}
        system = Quadrotor(chosen.model_copy(update=update))
        scenes = [scene.id for scene in system.library(LIBRARY).scenes[first:last]]
        faults = ()
        if cell.fault is not None:
            fault = parse_fault(
                cell.fault, system.interface, system.fault_presets, system.control_dt_s
            )
            assert isinstance(fault, Coupled)
            faults = (fault,)
        with arithmetic():
            flights, ended = fly_recorded(system, cell.variant, scenes, seed, faults)
            count = range(len(scenes))
            data = FlightData.decode(
                "search", encode_rows(count, flights), encode_episodes(count, flights)
            )
            found = self._measured(cell, seed, data, first)
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
        self, cell: Cell, seed: int, data: FlightData, first: int
    ) -> list[dict[str, Any]]:
        place = places(data, STRIDE)
        if not cell.measured or not len(place):
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
            for model, error in cell.measured
        ]
