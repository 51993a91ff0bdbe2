"""Measure everything side by side; `tools/documents.py` makes the page of it.

python -m benchmarks [--rounds N] [ROW ...]   rows that are named are shown and not kept
python -m benchmarks --new [ROW ...]          rows that results.json lacks, or that are named,
                                              are put among those it has
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
from benchmarks.results import ROOT, TIMES, Machine, Record, Results, load, record, save
from benchmarks.rows import ROWS, SIDES, Row
from faultpath.run.provenance import checkout, processor

ONE_THREAD = {"OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
PACKAGES = ["numpy", "scipy", "torch", "mujoco", "pytorch-mppi", "rotorpy", "torchrl"]


class NotMeasured(Exception):
    """A side that could not be built, or that gives other numbers than ours."""


def timed(side: str, loops: int) -> tuple[float, int, str]:
    """Time one side with pyperf in processes of its own, on the last processor.

    Return units of work a second, the calls that make a value, for the next round, and the side's
    note; `loops` 0 lets pyperf find them.
    """
    measured = SIDES[side]
    environment = measured.environment
    with tempfile.TemporaryDirectory() as folder:
        output, python = Path(folder) / "output.json", sys.executable
        if measured.python:
            python, problem = str(ROOT / measured.python), str(Path(folder) / "problem.npz")
            if not os.access(python, os.X_OK):
                raise NotMeasured(f"{side} needs a newer Python, which `make bench` did not find")
            write = [sys.executable, "-m", "benchmarks.peers.batched", problem]
            subprocess.run(write, cwd=ROOT, check=True)
            environment = {**environment, "FAULTPATH_PROBLEM": problem}
        often = ["--values=3", "--warmups=1", "--min-time=0.1", f"--loops={loops}"]
        if measured.once:
            often = ["--values=1", "--warmups=0", "--loops=1"]
        command = [python, "-m", "benchmarks.side", measured.build, "--processes=1", *often]
        command += [f"--output={output}", "--quiet", "--copy-env"]
        command += [f"--affinity={max(os.sched_getaffinity(0))}"]
        done = subprocess.run(
            command,
            cwd=ROOT,
            env={**os.environ, **ONE_THREAD, **environment},
            capture_output=True,
            text=True,
        )
        if done.returncode:
            lines = [line for line in done.stderr.splitlines() if not line.startswith("ERROR:")]
            raise NotMeasured(f"{side}: {lines[-1] if lines else 'no message'}")
        bench = pyperf.Benchmark.load(str(output))
    metadata = bench.get_metadata()
    loops = bench.get_total_loops() // bench.get_nvalue()
    note = metadata.get("note", "")
    if measured.once:
        note = f"{page.number(metadata['mem_max_rss'] / 2**30)} GB of memory"
    return float(metadata["amount"]) / bench.median(), loops, note


def measure(rows: Sequence[Row], rounds: int) -> list[Record]:
    """Let the sides of some rows take turns and return the records."""
    sides = dict.fromkeys(side for row in rows for side in (row.ours, row.peer) if side)
    rates: dict[str, list[float]] = {side: [] for side in sides}
    loops, missing, notes = dict.fromkeys(sides, 0), dict[str, str](), dict[str, str]()
    for number in range(rounds):
        for side in sides:
            if side in missing:
                continue
            try:
                rate, loops[side], notes[side] = timed(side, loops[side])
            except NotMeasured as reason:
                missing[side] = f"Not measured: {reason}"
                continue
            rates[side].append(rate)
            print(f"round {number + 1}, {side}: {page.number(rate)} /s", flush=True)
    return [_record(row, rates, missing, notes) for row in rows]


def _record(
    row: Row, rates: dict[str, list[float]], missing: dict[str, str], notes: dict[str, str]
) -> Record:
    for side in (row.ours, row.peer):
        if side in missing:
            return Record(name=row.name, unit=row.unit, target=row.target, note=missing[side])
    ours, peer = (rates.get(side, []) for side in (row.ours, row.peer))
    if row.unit in TIMES:
        ours, peer = ([TIMES[row.unit] / rate for rate in side] for side in (ours, peer))
    measured = record(row.name, row.unit, ours, peer, row.peer, row.target)
    return measured.model_copy(update={"note": notes.get(row.peer or row.ours, "")})


def describe() -> Machine:
    """Return this machine and the code on it."""
    kernels = native.kernels()
    commit, _ = checkout(Path(faultpath.__file__), [Path(faultpath.__file__).parent])
    installed = {package.name.replace("_", "-"): package.version for package in distributions()}
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
    parser = argparse.ArgumentParser(prog="benchmarks", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("rows", nargs="*", metavar="ROW", help="these rows, and keep nothing")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--new", action="store_true", help="keep them with what was measured")
    options = parser.parse_args()
    before = load() if options.new else None
    kept = {old.name: old for old in before.records} if before else {}
    lacking = [row for row in ROWS if row.name not in kept or kept[row.name].ours is None]
    named = [row for row in ROWS if row.name in options.rows]
    chosen = named if options.rows else lacking if options.new else [*ROWS]
    if len(chosen) < len(options.rows):
        parser.error(f"choose rows from {', '.join(repr(row.name) for row in ROWS)}")
    records = measure(chosen, options.rounds)
    print("\n".join(map(page.summary, records)))
    machine = describe()
    if before is not None:
        here = "" if machine.processor == before.machine.processor else f", {machine.processor}"
        machine, when = before.machine, f"measured on {machine.date}{here}"
        for new in records:
            note = new.note if new.ours is None else "; ".join(filter(None, (new.note, when)))
            kept[new.name] = new.model_copy(update={"note": note})
        records = [kept[row.name] for row in ROWS if row.name in kept]
    if options.new or not options.rows:
        save(Results(machine=machine, records=tuple(records)))


if __name__ == "__main__":
    main()
