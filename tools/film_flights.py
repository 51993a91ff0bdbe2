"""Flies the trials of the quadrotor's film again, and stores their tracks and the wind.

    python tools/film_flights.py decision/363 2

Each is a trial of the reference run `quadrotor-L3-decision`, and has to repeat to the bit.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from blocks import OUTCOMES, REFERENCE, Wrong, load
from film_halves import STORIES
from numpy.typing import NDArray
from pydantic import BaseModel
from repeats import planned

from faultpath.api.replaying import outcomes_at
from faultpath.run.attempt import Done
from faultpath.run.check.blocks import BlockSpec, run_block
from faultpath.run.execution.recheck import deviation
from faultpath.run.store.folder import read_outcomes
from faultpath.run.store.tables import TrialAddress

RUN = STORIES["quadrotor"]["run"]
FLIGHTS = Path(__file__).with_suffix(".json")
SHOWN = [half["condition"] for half in STORIES["quadrotor"]["halves"]]
"""Conditions of the two halves of the film."""


class Flight(BaseModel):
    """One trial: where it was from above at each control step and at its end, in centimetres."""

    variant: str
    condition: str
    places_cm: list[tuple[int, int]]


class Flights(BaseModel):
    """A scene's trials, and its wind, which is the same in all of them."""

    scene: str
    seed: int
    flights: list[Flight]
    wind_cm_s: list[tuple[int, int]]
    """East and north, at each control step of the longest trial."""

    def of(self, condition: str, variant: str) -> Flight:
        """Return a variant's trial under a condition."""
        trials = {(flight.condition, flight.variant): flight for flight in self.flights}
        return trials[condition, variant]


def flown(scene: str, seed: int) -> Flights:
    """Run the trials again; `Wrong` where one differs from the run."""
    run = load(RUN)
    before = outcomes_at(read_outcomes(REFERENCE / RUN / OUTCOMES))
    if (scene, seed) not in {(at.scene, at.seed) for at in before}:
        raise Wrong(f"{RUN} has no scene {scene} with seed {seed}: choose another one")
    system, plan = planned(run)
    flights: list[Flight] = []
    winds: dict[TrialAddress, list[tuple[int, int]]] = {}
    for row in plan.rows:
        if row.condition not in SHOWN or row.seed != seed:
            continue
        at = TrialAddress(row.variant, row.condition, seed, scene)
        block = run_block(system, BlockSpec(row.treatment, (scene,), signals=True))
        again = tuple(replace(outcome, trace=None) for outcome in block.outcomes)
        if differs := block.error or deviation([before[at]], Done(again, ())):
            raise Wrong(f"{at.variant}, {at.condition}: the trial {differs}")
        (track,) = (outcome.trace for outcome in block.outcomes if outcome.trace is not None)
        (wind,) = (signal.values for signal in block.signals[0] if signal.name == "true_wind")
        places, winds[at] = centimetres(track), centimetres(wind)
        flights.append(Flight(variant=at.variant, condition=at.condition, places_cm=places))
    longest = max(winds.values(), key=len)
    if any(wind != longest[: len(wind)] for wind in winds.values()):
        raise Wrong("the trials do not have the same wind")
    return Flights(scene=scene, seed=seed, flights=flights, wind_cm_s=longest)


def centimetres(metres: NDArray[np.float32]) -> list[tuple[int, int]]:
    """Return the first two components of vectors, in whole centimetres."""
    return [(east, north) for east, north, *_ in np.rint(100 * metres).astype(int).tolist()]


def main() -> int:
    """Carry out the command line; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("seed", type=int)
    options = parser.parse_args()
    try:
        FLIGHTS.write_text(flown(options.scene, options.seed).model_dump_json() + "\n", "utf-8")
    except Wrong as wrong:
        print(f"film_flights.py: {wrong}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
