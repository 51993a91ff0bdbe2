"""Measure points of the space, several processes at a time, and keep every one that was tried.

    python search.py FOLDER POINTS.json --scenes 50                physics alone: no fit
    python search.py FOLDER POINTS.json --scenes 50 --fitted gru   fits the reconstruction alone
    python search.py FOLDER POINTS.json --scenes 50 --fitted all
    python search.py FOLDER --show

`POINTS.json` holds {"name": {parameters that differ from the former platform}}. The same command
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

from judged import CELLS, STAND_INS, WITH_GRU, judged, quantities
from space import FORMER, platform_of

HERE = Path(__file__).parent
FITTED = {
    "none": ([], STAND_INS),
    "gru": (["gru"], WITH_GRU),
    "all": (["wm-a", "gru", "wm-a-wind", "wm-a-nowind"], CELLS),
}


def main() -> None:
    """Do what was asked."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("points", type=Path, nargs="?")
    parser.add_argument("--scenes", type=int, default=50)
    parser.add_argument("--fitted", choices=FITTED, default="none")
    parser.add_argument("--seeds", default="0")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--show", action="store_true")
    asked = parser.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    path = asked.folder / "search.json"
    record: list[dict[str, Any]] = json.loads(path.read_text()) if path.exists() else []
    if asked.show:
        for trial in sorted(record, key=lambda each: each["distance"]):
            print(line(trial))
        return
    seeds = [int(seed) for seed in asked.seeds.split(",")]
    rung = {"scenes": asked.scenes, "fitted": asked.fitted, "seeds": seeds}
    fitted, cells = FITTED[asked.fitted]
    given: dict[str, dict[str, Any]] = json.loads(asked.points.read_text())
    done = {(t["name"], t["scenes"], t["fitted"], len(t["seeds"])) for t in record}
    waiting = [name for name in given if (name, asked.scenes, asked.fitted, len(seeds)) not in done]
    running: dict[str, subprocess.Popen[bytes]] = {}
    while waiting or running:
        while waiting and len(running) < asked.workers:
            name = waiting.pop(0)
            job = {
                "point": FORMER | given[name],
                "code": commit(),
                "fitted": fitted,
                "seeds": seeds,
                "cells": cells,
                "bounds": [n for n in (0, 20, 50, 100) if n <= asked.scenes],
            }
            file = asked.folder / f"{name}.job.json"
            file.write_text(json.dumps(job))
            log = (asked.folder / f"{name}.log").open("w")
            command = [sys.executable, str(HERE / "measure.py"), str(file), str(asked.folder)]
            environment = {**os.environ, "OMP_NUM_THREADS": "1"}
            running[name] = subprocess.Popen(command, stdout=log, stderr=log, env=environment)
        time.sleep(0.5)
        for name, process in list(running.items()):
            if process.poll() is None:
                continue
            del running[name]
            if process.returncode:
                print(f"{name} failed: see {name}.log", flush=True)
                continue
            found = json.loads((asked.folder / f"{name}.job.found.json").read_text())
            point = FORMER | given[name]
            if asked.fitted == "none":
                found["GRU, L3"] = found["truth, L3"]
            what = [q for q in quantities() if q.cell in found and (fitted or q.label != "gru")]
            what = [q for q in what if fitted or q.name != "success, GRU, L3"]
            what = [q for q in what if asked.fitted == "all" or q.name != "common error, WM-A"]
            trial = {"name": name, **rung, "point": point, "hash": platform_of(point).hash}
            record.append({**trial, **judged(found, what)})
            path.write_text(json.dumps(record, indent=1) + "\n")
            print(line(record[-1]), flush=True)


def line(trial: dict[str, Any]) -> str:
    """Return a trial in a few lines."""
    differs = {k: v for k, v in trial["point"].items() if v != FORMER[k]}
    rows = [
        f"{name} {row['value']} ({row['target']:.3g}; {row['departure']:+.1f})"
        for name, row in trial["quantities"].items()
    ]
    rung = f"scenes {trial['scenes']} fitted {trial['fitted']} seeds {trial['seeds']}"
    head = f"## {trial['name']} {rung}"
    return "\n".join(
        [f"{head}: {trial['distance']} {trial['groups']}", json.dumps(differs), "; ".join(rows)]
    )


def commit() -> str:
    """Return the commit of the code that measures."""
    asked = ("git", "-C", str(HERE), "describe", "--always", "--dirty")
    return subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()


if __name__ == "__main__":
    main()
