"""Measure points of the space, several processes at a time, and keep every one that was tried.

    python search.py FOLDER POINTS.json --scenes 50
    python search.py FOLDER FINALISTS.json --scenes 100 --seeds 0,1,2
    python search.py FOLDER --show
    python search.py FOLDER --table

`POINTS.json` holds {"name": {parameters that differ from s2}}. The same command
goes on where it was cut short. `FOLDER/search.json` is the record.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from judged import CELLS, judged
from space import S2, platform_of

HERE = Path(__file__).parent
FITTED = ["wm-a", "gru", "wm-a-wind", "wm-a-nowind", "wm-u"]


def main() -> None:
    """Measure the points of a file, or show those that were measured."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("points", type=Path, nargs="?")
    parser.add_argument("--scenes", type=int, default=50)
    parser.add_argument("--seeds", default="0")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--show", action="store_true")
    parser.add_argument("--table", action="store_true")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    path = options.folder / "search.json"
    if options.show:
        for trial in sorted(read(path), key=lambda trial: trial["distance"]):
            print(line(trial))
        return
    if options.table:
        print(table(read(path)))
        return
    seeds = [int(seed) for seed in options.seeds.split(",")]
    running: dict[str, subprocess.Popen[bytes]] = {}
    while True:
        # The file is read again each time: points may be added while others are measured.
        points: dict[str, dict[str, Any]] = json.loads(options.points.read_text())
        done = {(t["name"], t["scenes"], len(t["seeds"])) for t in read(path)}
        done |= {(name, options.scenes, len(seeds)) for name in failed}
        waiting = [
            name
            for name in points
            if name not in running and (name, options.scenes, len(seeds)) not in done
        ]
        if not waiting and not running:
            return
        while waiting and len(running) < options.workers:
            name = waiting.pop(0)
            running[name] = start(options, name, S2 | points[name], seeds)
        time.sleep(0.5)
        for name, process in list(running.items()):
            if process.poll() is None:
                continue
            del running[name]
            if process.returncode:
                print(f"{name} failed: see {name}.log", flush=True)
                failed.add(name)
                continue
            flown = json.loads(
                job_path(options, name, seeds).with_suffix(".found.json").read_text()
            )
            first = {
                cell: blocks[: len(bounds(options.scenes)) - 1] for cell, blocks in flown.items()
            }
            point = S2 | points[name]
            trial = {"name": name, "scenes": options.scenes, "seeds": seeds, "point": point}
            trial |= {"hash": platform_of(point).hash, "code": commit(), **judged(flown, first)}
            path.write_text(json.dumps([*read(path), trial], indent=1) + "\n")
            print(line(trial), flush=True)


failed: set[str] = set()


def read(path: Path) -> list[dict[str, Any]]:
    """Return the points that were measured."""
    return json.loads(path.read_text()) if path.exists() else []


def bounds(scenes: int) -> list[int]:
    """Return where blocks of scenes begin and end."""
    return [n for n in (0, 50, 100) if n <= scenes]


def job_path(options: argparse.Namespace, name: str, seeds: list[int]) -> Path:
    """Return the file of a job."""
    return options.folder / f"{name}-{options.scenes}-{len(seeds)}.job.json"


def start(
    options: argparse.Namespace, name: str, point: dict[str, Any], seeds: list[int]
) -> "subprocess.Popen[bytes]":
    """Start to measure a point in a process of its own."""
    job = {
        "point": point,
        "code": commit(),
        "fitted": FITTED,
        "seeds": seeds,
        "cells": CELLS,
        "bounds": bounds(options.scenes),
    }
    file = job_path(options, name, seeds)
    file.write_text(json.dumps(job))
    log = (options.folder / f"{name}.log").open("a")
    command = [sys.executable, str(HERE / "measure.py"), str(file)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(
        [*command, str(options.folder)], stdout=log, stderr=log, env=environment
    )


def line(trial: dict[str, Any]) -> str:
    """Return a trial in a few lines."""
    differs = {k: v for k, v in trial["point"].items() if v != S2[k]}
    rows = [
        f"{name} {row['value']} ({row['target']:.3g}; {row['departure']:+.1f})"
        for name, row in trial["quantities"].items()
    ]
    rung = f"scenes {trial['scenes']} seeds {trial['seeds']}"
    head = f"## {trial['name']} {rung}: {trial['distance']} {trial['tables']}"
    soundness = f"{trial['constraints']} {'sound' if trial['sound'] else 'NOT SOUND'}"
    return "\n".join([head, json.dumps(differs), soundness, "; ".join(rows)])


COLUMNS = {
    "GRU": "success, GRU, L3",
    "alone": "success, GRU, reconstruction only",
    "shared": "success, GRU, shared",
    "truth": "success, truth, L3",
    "withheld": "success, withheld, L3",
    "zero": "success, zero, L3",
    "withheld, free": "success, withheld, L3, free",
    "error": "acceleration error, GRU",
}


def table(trials: list[dict[str, Any]]) -> str:
    """Return all points as a table, the nearest first."""
    parts = list(trials[0]["tables"])
    first = {column: trials[0]["quantities"][name]["target"] for column, name in COLUMNS.items()}
    rows = [
        f"| point | differs from s2 | scenes, seeds | distance | {' | '.join(parts)} | sound | "
        f"{' | '.join(COLUMNS)} |",
        "| :-- | :-- | :-- |" + " --: |" * (2 + len(parts) + len(COLUMNS)),
        "| *the paper* |"
        + " |" * (4 + len(parts))
        + "".join(f" {x:.2f} |" for x in first.values()),
    ]
    for trial in sorted(trials, key=lambda trial: (trial["scenes"], trial["distance"])):
        differs = ", ".join(f"{k} {v}" for k, v in trial["point"].items() if v != S2[k])
        values = [trial["quantities"][name]["value"] for name in COLUMNS.values()]
        distances = " | ".join(f"{part:.2f}" for part in trial["tables"].values())
        rows.append(
            f"| {trial['name']} | {differs} | {trial['scenes']}, {len(trial['seeds'])} | "
            f"{trial['distance']:.2f} | {distances} | "
            f"{'yes' if trial['sound'] else 'no'} | {' | '.join(f'{v:.2f}' for v in values)} |"
        )
    return "\n".join(rows)


def commit() -> str:
    """Return the commit of the code that measures."""
    asked = (
        "git",
        "-C",
        str(HERE),
        "log",
        "-1",
        "--format=%h",
        "--",
        "../../src",
        "../../quadrotor/src",
    )
    return subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()


if __name__ == "__main__":
    main()
