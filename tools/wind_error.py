"""Why a frozen wind costs what it does: what the estimate is worth at each moment of a flight.

    python tools/wind_error.py

Flies once more the flights of `tools/frozen_wind.py` whose wind is updated, with its reconstruction
and with the one that learned from the collection, and listens to what each says and what the wind
is. Writes `docs/reference/wind-error.json`.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from blocks import REFERENCE, parsed
from flown_code import ROOT
from frozen_wind import STEPS, UPDATED
from machine import Machine
from numpy.typing import NDArray

from faultpath.execution.attempt import Done
from faultpath.record import wording
from faultpath.review.hearing import Values, fly_heard, laid_out, steps_of
from faultpath.statistics import Contrast, Resamples, median_effect
from faultpath.studies.cells import SYSTEM
from faultpath.studies.entries import bracket
from faultpath.studies.pages.table_3 import GRU, TRAJECTORY
from faultpath.tables import MISSING, Line, Table, line
from faultpath.tables.markdown import block
from faultpath.trials import Arm, System, SystemSpec, library_of, load_system

RESULT = REFERENCE / "wind-error.json"
MOVING_MPS = 0.05
"""Slower than that, nothing is said of the direction of motion."""
UNIT = "m/s"
LIBRARY = UPDATED.setting.library
LABELS = {TRAJECTORY: "Trajectory GRU", GRU: "GRU"}
"""What the table calls each reconstruction."""


class Measured(Machine):
    """The table, and how it was made."""

    table: Table


@dataclass(frozen=True)
class Flight:
    """What was heard in one trial, `[T, 3]` each, m/s in the world frame."""

    estimate: Values
    wind: Values
    velocity: Values

    def flying(self, step: int) -> bool:
        """Return whether the trial still ran at a control step."""
        return step < len(self.wind)

    def error(self, step: int) -> Values:
        """Return the error of the estimate at a step, `[3]`."""
        return self.estimate[step] - self.wind[step]

    def along(self, step: int) -> float:
        """Return its component along the motion; not a number for a vehicle that hardly moves."""
        speed = float(np.linalg.norm(self.velocity[step]))
        return self.error(step) @ self.velocity[step] / speed if speed > MOVING_MPS else np.nan

    def left(self, held: Values, step: int) -> float:
        """Return the mean error from a step on of `held`, an estimate `[3]` or one a step."""
        return float(np.linalg.norm(held - self.wind[step:], axis=1).mean())


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly, measure and write; return the exit status."""
    argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0]).parse_args(arguments)
    torch.set_num_threads(1)
    machine = Machine.here(ROOT / "src" / "faultpath")
    system = load_system(SystemSpec(name=SYSTEM, options=UPDATED.setting.options))
    flights = {variant: _flown(system, variant) for variant in LABELS}
    measured = Measured(**machine.model_dump(), table=_table(flights))
    RESULT.write_text(measured.model_dump_json(indent=1) + "\n", "utf-8")
    print(f"Written: {RESULT}")
    return 0


def _flown(system: System, variant: str) -> list[Flight]:
    scenes = [scene.id for scene in library_of(system, LIBRARY).scenes]
    done, heard = fly_heard(system, Arm(variant=variant), scenes)
    if not isinstance(done, Done):
        raise SystemExit(f"The flights of {variant} failed: {done.error}")
    said = heard.got["wind", "predictor.wind_map"]
    wind, velocity = heard.sources["true_wind"], heard.sources["vehicle.velocity"]
    return [
        Flight(*(laid_out(held, scene, taken) for held in (said, wind, velocity)))
        for scene, taken in enumerate(steps_of(done, system.control_dt_s))
    ]


def _table(flights: Mapping[str, Sequence[Flight]]) -> Table:
    scenes = len(flights[UPDATED.variant])
    resamples = Resamples.draw(LIBRARY, scenes)
    lines: list[Line] = []
    for variant, flown in flights.items():
        lines += [line(LABELS[variant]), *(_line(flown, step, resamples) for step in STEPS)]
    return Table(
        title="Error of the reconstructed wind along a flight, free space at L3",
        columns=(
            "Flying",
            "Speed (m/s)",
            "Error then (m/s)",
            "Along the motion (m/s)",
            "Held from then on (m/s)",
            "Updated (m/s)",
            "Held minus updated (m/s)",
        ),
        lines=tuple(lines),
        notes=(
            "Medians over the scenes that are still flying; the flights are those in which the "
            "wind is updated. Error: length of the estimate minus the wind; along the motion: its "
            "component in the direction of flight, below zero against it. Held, updated: mean "
            "error over the rest of the flight of the estimate of that step, and of that of each.",
            f"{scenes} scenes of the {LIBRARY} library, seed 0. Intervals, 95 %, for these trained "
            "models: percentile bootstrap of whole scenes. Errors are secondary: nothing is "
            "decided from them.",
        ),
    )


def _line(flights: Sequence[Flight], step: int, resamples: Resamples) -> Line:
    flying = np.array([flight.flying(step) for flight in flights])

    def each(values: Sequence[float]) -> NDArray[np.float64]:
        filled = np.full(len(flights), np.nan)
        filled[flying] = values
        return filled

    on = [flight for flight in flights if flight.flying(step)]
    speed = each([float(np.linalg.norm(flight.velocity[step])) for flight in on])
    error = each([float(np.linalg.norm(flight.error(step))) for flight in on])
    along = each([flight.along(step) for flight in on])
    held = each([flight.left(flight.estimate[step], step) for flight in on])
    updated = each([flight.left(flight.estimate[step:], step) for flight in on])
    moving = ~np.isnan(along)
    towards = _told(along, np.zeros_like(along), moving, resamples) if moving.any() else MISSING
    medians = (wording.plain(float(np.nanmedian(each)), 2) for each in (held, updated))
    return line(
        f"Step {step}",
        str(len(on)),
        wording.plain(float(np.nanmedian(speed)), 2),
        wording.plain(float(np.nanmedian(error)), 2),
        towards,
        *medians,
        _told(held, updated, flying, resamples),
    )


def _told(
    first: NDArray[np.float64],
    second: NDArray[np.float64],
    counted: NDArray[np.bool_],
    resamples: Resamples,
) -> str:
    found: Contrast = median_effect(first, second, counted, resamples, UNIT)
    ends = "" if found.interval is None else f" {bracket(found.interval, 2)}"
    return f"{wording.signed(found.value, 2)}{ends}"


def fill() -> str:
    """Return the block of the page."""
    if not RESULT.exists():
        return "*Not measured yet: run `python tools/wind_error.py`.*"
    found = parsed(RESULT, Measured, "run python tools/wind_error.py")
    return f"{block(found.table)}\n\nMeasured {found.words}. Made by `python tools/wind_error.py`."


if __name__ == "__main__":
    sys.exit(main())
