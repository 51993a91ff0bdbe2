"""What trials cost on Ray workers of this machine, and what a million of them would.

    python tools/ray_cost.py                     on a quiet machine
    python tools/ray_cost.py --only toy --try    a few trials; nothing is kept

Each audit is made twice, with few trials and with more, by processes and by Ray workers. What the
longer one takes beyond the shorter is the price of trials; the rest is the price of starting.
Writes `docs/reference/ray-cost.json`, of which `docs/many-trials.md` makes its tables.
"""

import argparse
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from blocks import REFERENCE, Run, parsed, tabled
from flown_code import ROOT
from machine import Machine, Others, busy
from pydantic import BaseModel

import faultpath

RESULT = REFERENCE / "ray-cost.json"
MANY = 1_000_000
_MILLION = f"{MANY:,}".replace(",", " ")
WORKERS = (1, 2, 4)
FARTHER = (64, 256, 1024)
"""Workers for which times are extrapolated."""
LONGER = {"": 0.0, ", were each 0.1 s longer": 0.1, ", were each 1 s longer": 1.0}
"""Seconds by which a trial of somebody else's may be longer."""
CASES: Mapping[str, tuple[Mapping[str, Any], Mapping[str, Any], Mapping[str, Any]]] = {
    "toy": (
        {
            "system": ROOT / "examples" / "toy.py",
            "baseline": "calibrated",
            "repair": "blind",
            "fault": "gain:scale=0.6",
            "library": "carts",
        },
        {"seeds": range(5)},
        {"seeds": range(40)},
    ),
    "quadrotor": (
        {
            "system": "quadrotor",
            "baseline": "gru",
            "repair": "gru+dcc",
            "fault": "calibration=+0.1",
            "library": "selection",
            "options": {"wind": "L3"},
        },
        {"scenes": 8},
        {"scenes": 24},
    ),
}
"""What is audited, with few trials and with more."""


class Spent(BaseModel):
    """What one audit took."""

    trials: int
    wall_s: float
    driver_s: float
    """Processor time of the process that hands trials out and stores them."""


class Timed(BaseModel):
    """One audit with few trials and with more, on so many workers."""

    case: str
    executor: str
    workers: int
    few: Spent
    more: Spent
    others: float | None
    """Share of the processor that other work took; None for Ray, whose workers count as others."""

    @property
    def trials(self) -> int:
        """How many more."""
        return self.more.trials - self.few.trials

    @property
    def trial_s(self) -> float:
        """Seconds by the clock that one trial more takes."""
        return (self.more.wall_s - self.few.wall_s) / self.trials

    @property
    def driver_s(self) -> float:
        """Of the driver's processor time."""
        return (self.more.driver_s - self.few.driver_s) / self.trials


class Cost(Machine):
    """All that was measured, and on what."""

    ray: str
    timed: tuple[Timed, ...]


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--only", choices=CASES, help="one of the audits")
    parser.add_argument("--try", dest="brief", action="store_true", help="few trials, none kept")
    asked = parser.parse_args(arguments)
    machine = Machine.here(ROOT / "src" / "faultpath")
    cases = [asked.only] if asked.only else list(CASES)
    for case in cases:  # what the first audit of a process loads is no price of its trials
        _spent(CASES[case][0] | {"scenes": 1}, "local", 1)
    timed = [
        _timed(case, executor, workers, asked.brief)
        for case in cases
        for workers in WORKERS
        for executor in ("local", "ray")
    ]
    if any(each.trial_s <= 0 for each in timed):
        print("More trials took no longer than few: nothing is kept; run it on a quiet machine.")
        return 1
    cost = Cost(**machine.model_dump(), ray=version("ray"), timed=tuple(timed))
    print(_measured(cost) if asked.brief else f"Written: {RESULT}")
    if not asked.brief:
        RESULT.write_text(cost.model_dump_json(indent=1) + "\n", "utf-8")
    return 0


def _timed(case: str, executor: str, workers: int, brief: bool) -> Timed:
    common, few, more = CASES[case]
    if brief:
        few, more = {"scenes": 2}, {"scenes": 6}
    others = Others()
    spent = [_spent(common | size, executor, workers) for size in (few, more)]
    found = Timed(
        case=case,
        executor=executor,
        workers=workers,
        few=spent[0],
        more=spent[1],
        others=others.share() if executor == "local" else None,
    )
    print(f"{case}, {executor}, {workers}: {1000 * found.trial_s:.2f} ms a trial", flush=True)
    return found


def _spent(asked: Mapping[str, Any], executor: str, workers: int) -> Spent:
    with tempfile.TemporaryDirectory() as folder:
        wall, driver = time.monotonic(), time.process_time()
        run = faultpath.audit(
            folder=Path(folder) / "run", executor=executor, workers=workers, progress=False, **asked
        )
        return Spent(
            trials=Run("", run.record, run.provenance).trials,
            wall_s=time.monotonic() - wall,
            driver_s=time.process_time() - driver,
        )


def fill() -> str:
    """Return the tables of the page."""
    if not RESULT.exists():
        return "*Not measured yet: `python tools/ray_cost.py` does it.*"
    cost = parsed(RESULT, Cost, "run python tools/ray_cost.py")
    return "\n\n".join([_where(cost), _measured(cost), _extrapolated(cost)])


def _where(cost: Cost) -> str:
    others = max(each.others for each in cost.timed if each.others is not None)
    told = "That is the most in any run by processes; what Ray starts is not told from other work."
    return f"Measured {cost.words}, Ray {cost.ray}. {busy(others)} {told}"


def _measured(cost: Cost) -> str:
    rows = [
        {
            "name": each.case,
            "on": "processes" if each.executor == "local" else "Ray",
            "workers": each.workers,
            "starting": each.few.wall_s - each.few.trials * each.trial_s,
            "rate": 1 / each.trial_s,
            "driver": 1000 * each.driver_s,
            "hours": MANY * each.trial_s / 3600,
        }
        for each in cost.timed
    ]
    columns = {
        "on": "{on}",
        "workers": "{workers}",
        "start and end, s": "{starting:1}",
        "trials a second": "{rate:1}",
        "driver a trial, ms": "{driver:2}",
        f"{_MILLION} trials, h": "{hours:1}",
    }
    return tabled("audit", rows, columns, code=True, words="on")


def _extrapolated(cost: Cost) -> str:
    rows = [
        _shared_out(f"{each.case}{name}", each.trial_s + longer_s, each.driver_s)
        for each in cost.timed
        if (each.executor, each.workers) == ("ray", 1)
        for name, longer_s in LONGER.items()
    ]
    columns = {"worker hours": "{one:1}"}
    columns |= {f"{n} workers, h": f"{{on{n}:2}}" for n in FARTHER}
    columns |= {"the driver keeps up with": "{fed:0} workers"}
    return tabled(f"{_MILLION} trials of", rows, columns)


def _shared_out(name: str, trial_s: float, driver_s: float) -> Mapping[str, Any]:
    hours = {f"on{n}": MANY * max(trial_s / n, driver_s) / 3600 for n in FARTHER}
    fed = max(1.0, trial_s / driver_s) if driver_s > 0 else float("inf")
    return {"name": name, "one": MANY * trial_s / 3600, "fed": fed} | hours


if __name__ == "__main__":
    sys.exit(main())
