"""Whether the repair costs success under correct inputs where reconstructions err as the paper's.

    python tools/erring_reconstructions.py FOLDER     where what is fitted and flown is kept

The paper's reconstructions err twice as much as ours. Two assumptions are changed, one at a time,
and Table IV's first question is asked again beside the platform as it is frozen:

- a less steady wind: turbulence and gusts are so much stronger that the observer, which learns
  nothing, errs as the paper's does, on windows that it flew itself; what sees wind in training is
  fitted again on such flights;
- fewer training flights: so few in wind that the GRU errs as the paper's does.

Each design was committed before the repair was flown in it, on the selection library; the second
was made when the first had been flown. The reversal came with few flights, so that was flown on the
held-out scenes too, once, as it was. Ships records and trials in
`docs/reference/erring-reconstructions`.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from blocks import copied
from erring_blocks import DECIDED, ERRORS, RUNS, Erring, few_flights, less_steady
from erring_flown import (
    FITTED,
    SEEDS,
    acceleration_errors,
    audited,
    completed,
    fitted,
    observer_error,
    pools,
    poor,
)
from flown_code import ROOT
from machine import Machine

from faultpath.store.folder import OUTCOMES
from faultpath.studies.cells import HELD_OUT, SELECTION
from faultpath.work import Executor, local, run_all

SHIPPED = {OUTCOMES: OUTCOMES, "record.json": DECIDED}
"""Under a name of its own: without the rest of its folder a record is no run."""
TIMES = tuple(1 + quarter / 4 for quarter in range(9))
"""How many times stronger than the frozen ones turbulence and gusts are tried."""
FLIGHTS = tuple(14_891 // 2**halved for halved in range(1, 8))
"""How many training flights in wind are tried; the paper's number is what the shipped have."""
RECONSTRUCTED, GIVEN = ("gru", "gru+dcc"), ("zero-wind", "true-wind")
"""The arms whose difference is asked for, and those that say how strong the wind is."""
Conditions = Mapping[str, tuple[float, Path | None]]
"""By name: how many times stronger the wind varies, and the models; none: those shipped."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, fit, fly and ship; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    folder = parser.parse_args(arguments).folder
    with local(2) as hands:
        tried = [partial(observer_error, times, folder) for times in TIMES]
        winds = {TIMES[place]: error for place, error in run_all(hands, tried)}
        # Models are looked up from the root: a relative name would be taken from the package.
        unsteady = _unsteady(hands, less_steady(winds), folder.resolve())
        trained = [partial(poor, flights, folder.resolve()) for flights in FLIGHTS]
        flights = {FLIGHTS[place]: error for place, error in run_all(hands, trained)}
        few = _few(hands, few_flights(flights), folder.resolve())
        conditions: Conditions = {
            "frozen": (1.0, None),
            "unsteady": (less_steady(winds), unsteady),
            "few-flights": (1.0, few),
        }
        erring = [partial(acceleration_errors, *each) for each in conditions.values()]
        table_6 = {list(conditions)[place]: found for place, found in run_all(hands, erring)}
        found = Erring(
            **Machine.here(ROOT / "src" / "faultpath").model_dump(),
            winds=dict(sorted(winds.items())),
            flights=dict(sorted(flights.items())),
            table_6={name: table_6[name] for name in conditions},
        )
        RUNS.mkdir(parents=True, exist_ok=True)
        (RUNS / ERRORS).write_text(found.model_dump_json(indent=1) + "\n", "utf-8")
        _fly(hands, conditions, folder / "flown")
    return 0


def _unsteady(hands: Executor, times: float, folder: Path) -> Path:
    """Fit what sees wind in training on flights in a less steady one; return the models."""
    both = partial(pools, times, ("nominal", "wind"), None, folder / "data")
    ((_, data),) = run_all(hands, [both])
    return _fitted(hands, [(times, *model, data, folder / "models") for model in FITTED])


def _few(hands: Executor, flights: int, folder: Path) -> Path:
    """Fit the reconstructions on few flights in wind; return the models."""
    data, models = folder / f"data-{flights}", folder / f"models-{flights}"
    names = [(name, seed) for name in RECONSTRUCTED for seed in SEEDS]
    return _fitted(hands, [(1.0, name, seed, data, models) for name, seed in names])


def _fitted(hands: Executor, asked: Sequence[tuple[float, str, int, Path, Path]]) -> Path:
    for place, _ in run_all(hands, [partial(fitted, *each) for each in asked]):
        print("Fitted:", *asked[place][1:3], flush=True)
    models = asked[0][-1]
    completed(models)
    return models


def _fly(hands: Executor, conditions: Conditions, flown: Path) -> None:
    """Audit in each condition what is not there yet, and ship it."""
    repair, given = (RECONSTRUCTED, SEEDS, SELECTION), (GIVEN, (0,), SELECTION)
    asked = {
        "frozen/repair": repair,
        "frozen/input": given,
        "unsteady/repair": repair,
        "unsteady/input": given,
        "few-flights/repair": repair,  # nothing that is given a wind has learned from those
        "few-flights/held-out": (RECONSTRUCTED, SEEDS, HELD_OUT),
    }
    missing = [place for place in asked if not (flown / place / "provenance.json").exists()]
    audits = [
        partial(audited, conditions[place.partition("/")[0]], *asked[place], flown / place)
        for place in missing
    ]
    for each, _ in run_all(hands, audits):
        print("Flown:", missing[each], flush=True)
    for place in asked:
        copied(SHIPPED, flown / place, RUNS / place)


if __name__ == "__main__":
    sys.exit(main())
