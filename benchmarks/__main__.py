"""Measure everything side by side; `tools/documents.py` makes the page of it.

python -m benchmarks [--rounds N] [ROW ...]   rows that are named are shown and not kept
"""

import argparse
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import distributions
from pathlib import Path

import pyperf
from faultpath_quadrotor import native

import faultpath
from benchmarks import page
from benchmarks.results import ROOT, Machine, Record, Results, record, save
from benchmarks.rows import ROWS, SIDES, Row
from faultpath.trials.execution.provenance import checkout, processor

ONE_THREAD = {"OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
PACKAGES = ["numpy", "scipy", "torch", "mujoco", "pytorch-mppi", "rotorpy"]


class NotMeasured(Exception):
    """A side that could not be built, or that gives other numbers than ours."""


def timed(side: str, loops: int) -> tuple[float, int]:
    """Time one side with pyperf in processes of its own, on the last processor.

    Return units of work a second, and the calls that make a value, for the next round; `loops` 0
    lets pyperf find them.
    """
    where, environment = SIDES[side]
    with tempfile.TemporaryDirectory() as folder:
        found = Path(folder) / "found.json"
        command = [sys.executable, "-m", "benchmarks.side", where, "--processes=1", "--values=3"]
        command += ["--warmups=1", "--min-time=0.1", f"--loops={loops}", f"--output={found}"]
        command += ["--quiet", "--copy-env", f"--affinity={max(os.sched_getaffinity(0))}"]
        done = subprocess.run(
            command,
            cwd=ROOT,
            env={**os.environ, **ONE_THREAD, **environment},
            capture_output=True,
            text=True,
        )
        if done.returncode:
            said = [line for line in done.stderr.splitlines() if not line.startswith("ERROR:")]
            raise NotMeasured(f"{side}: {said[-1] if said else 'no message'}")
        bench = pyperf.Benchmark.load(str(found))
    amount = float(bench.get_metadata()["amount"])
    return amount / bench.median(), bench.get_total_loops() // bench.get_nvalue()


def measure(rows: Sequence[Row], rounds: int) -> list[Record]:
    """Let the sides of some rows take turns and return the records."""
    sides = dict.fromkeys(side for row in rows for side in (row.ours, row.peer) if side)
    rates: dict[str, list[float]] = {side: [] for side in sides}
    loops, missing = dict.fromkeys(sides, 0), dict[str, str]()
    for number in range(rounds):
        for side in sides:
            if side in missing:
                continue
            try:
                rate, loops[side] = timed(side, loops[side])
            except NotMeasured as reason:
                missing[side] = f"Not measured: {reason}"
                continue
            rates[side].append(rate)
            print(f"round {number + 1}, {side}: {page.number(rate)} /s", flush=True)
    return [_record(row, rates, missing) for row in rows]


def _record(row: Row, rates: dict[str, list[float]], missing: dict[str, str]) -> Record:
    for side in (row.ours, row.peer):
        if side in missing:
            return Record(name=row.name, unit=row.unit, target=row.target, note=missing[side])
    ours, peer = (rates.get(side, []) for side in (row.ours, row.peer))
    if row.unit == "ms":
        ours, peer = ([1e3 / rate for rate in side] for side in (ours, peer))
    return record(row.name, row.unit, ours, peer, row.peer, row.target)


def describe() -> Machine:
    """Return this machine and the code on it."""
    kernels = native.kernels()
    commit, _ = checkout(Path(faultpath.__file__), [Path(faultpath.__file__).parent])
    installed = {each.name.replace("_", "-"): each.version for each in distributions()}
    return Machine(
        date=datetime.now(UTC).date().isoformat(),
        processor=processor(),
        cores=len(os.sched_getaffinity(0)),
        system=platform.platform(aliased=True),
        python=platform.python_version(),
        packages={name: installed[name] for name in PACKAGES if name in installed},
        kernels=native.PORTABLE if kernels is None else kernels.isa,
        commit=commit,
    )


def main() -> None:
    """Do what was asked."""
    parser = argparse.ArgumentParser(prog="benchmarks", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("rows", nargs="*", metavar="ROW", help="these rows, and keep nothing")
    parser.add_argument("--rounds", type=int, default=7)
    asked = parser.parse_args()
    chosen = [row for row in ROWS if not asked.rows or row.name in asked.rows]
    if len(chosen) < len(asked.rows):
        parser.error(f"choose rows from {', '.join(repr(row.name) for row in ROWS)}")
    found = measure(chosen, asked.rounds)
    print("\n".join(map(page.told, found)))
    if not asked.rows:
        save(Results(machine=describe(), records=tuple(found)))


if __name__ == "__main__":
    main()
