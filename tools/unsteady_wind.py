"""Whether a less steady wind explains why the repair costs nothing under correct inputs here.

    python tools/unsteady_wind.py FOLDER     where what is fitted and flown is kept

The paper's reconstructions err twice as much as ours, and so does its observer, which learns
nothing: its wind may vary more. The design, committed before a reconstruction was flown: turbulence
and gusts are made stronger until the observer errs as the paper's does, on windows that it flew
itself; what sees wind in training is fitted again on such flights, and Table IV's first question is
asked once more, beside the wind as it is frozen. Everything on the selection library. Ships
records and trials in `docs/reference/unsteady-wind`.
"""

import argparse
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from flown_code import ROOT
from machine import Machine
from unsteady_blocks import DECIDED, FLOWN, OBSERVED, RUNS, Observed, nearest
from unsteady_flown import (
    FITTED,
    SEEDS,
    acceleration_errors,
    audited,
    completed,
    fitted,
    observer_error,
    pools,
)

from faultpath.store import atomic
from faultpath.store.folder import OUTCOMES
from faultpath.work import local, run_all

SHIPPED = {OUTCOMES: OUTCOMES, "record.json": DECIDED, "provenance.json": FLOWN}
TIMES = tuple(1 + quarter / 4 for quarter in range(9))
"""How many times stronger than the frozen ones turbulence and gusts are tried."""
RECONSTRUCTED, GIVEN = ("gru", "gru+dcc"), ("zero-wind", "true-wind")
"""The arms whose difference is asked for, and those that say how strong the wind is."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, fit, fly and ship; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    folder = parser.parse_args(arguments).folder
    RUNS.mkdir(parents=True, exist_ok=True)
    with local(2) as hands:
        tried = [partial(observer_error, times, folder) for times in TIMES]
        errors = {TIMES[place]: error for place, error in run_all(hands, tried)}
        times, models = nearest(errors), folder.resolve() / "models"
        print(f"Observer: {errors}; {times:g} times", flush=True)

        ((_, data),) = run_all(hands, [partial(pools, times, folder)])
        fits = [partial(fitted, times, *model, data, models) for model in FITTED]
        for place, _ in run_all(hands, fits):
            print("Fitted:", *FITTED[place], flush=True)
        completed(models)

        winds = {"frozen": (1.0, None), "unsteady": (times, models)}
        erring = [partial(acceleration_errors, *wind) for wind in winds.values()]
        table_6 = {list(winds)[place]: found for place, found in run_all(hands, erring)}
        machine = Machine.here(ROOT / "src" / "faultpath")
        observed = Observed(
            **machine.model_dump(),
            error=dict(sorted(errors.items())),
            table_6={name: table_6[name] for name in winds},
        )
        (RUNS / OBSERVED).write_text(observed.model_dump_json(indent=1) + "\n", "utf-8")
        flown = folder / "flown"
        asked = [
            (flown / name / kind, partial(audited, strength, arms, drawn, source))
            for name, (strength, source) in winds.items()
            for kind, arms, drawn in (("repair", RECONSTRUCTED, SEEDS), ("input", GIVEN, (0,)))
        ]
        for place, _ in run_all(hands, [partial(audit, to) for to, audit in asked]):
            print("Flown:", asked[place][0], flush=True)
    for place, _ in asked:
        target = RUNS / place.relative_to(flown)
        target.mkdir(parents=True, exist_ok=True)
        for name, here in SHIPPED.items():
            atomic.write(target / here, (place / name).read_bytes())
    return 0


if __name__ == "__main__":
    sys.exit(main())
