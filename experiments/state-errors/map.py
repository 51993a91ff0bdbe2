"""Error of a sensor against error of the calibration: who is ahead where.

python experiments/state-errors/map.py [--out FOLDER]     # writes map.json beside itself
"""

import argparse
import json
from pathlib import Path

from faultpath.decisions.family import compared, decide_paths
from faultpath.faults import parse_fault, resolve
from faultpath.trials import Arm, Row, Study, SystemSpec, load_system
from faultpath.trials.execution.runner import run_study

OPTIONS = {"estimator": "eskf-no-bias", "wind": "L3"}
BASELINE, REPAIR = "gru", "gru+dcc"
SCALES = (-0.03, 0.0, 0.03)
"""Errors of the accelerometer's scale."""
CALIBRATIONS = (-0.1, 0.0, 0.1)
LIBRARY, SCENES = "selection", 100


def main() -> None:
    """Fly, decide and write."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=Path, default=Path("runs/state-errors/map"))
    out = parser.parse_args().out
    spec = SystemSpec(name="quadrotor", options=OPTIONS)
    system, rows = load_system(spec), []
    cells = {f"{scale:+g},{error:+g}": (scale, error) for scale in SCALES for error in CALIBRATIONS}
    for name, (scale, error) in cells.items():
        texts = [f"accelerometer:scale={1 + scale}"] * bool(scale)
        texts += [f"calibration={error}"] * bool(error)
        faults = [parse_fault(t, system.interface, system.fault_presets, 0.05) for t in texts]
        for variant in (BASELINE, REPAIR):
            found = resolve(faults, system.interface, system.variants[variant].consumers)
            arm = Arm(variant=variant, faults=found, seed=0)
            rows.append(Row(variant=variant, path=name, seed=0, arm=arm))
    scenes = tuple(each.id for each in system.library(LIBRARY).scenes[:SCENES])
    study = Study(name="state-map", system=spec, library=LIBRARY, scenes=scenes, rows=tuple(rows))
    table = run_study(study, out, 2).outcomes
    arms = compared(REPAIR, BASELINE, cells, table).arms
    effects = decide_paths(arms, rule="unconditional").effects
    found = {
        "library": LIBRARY,
        "scenes": SCENES,
        "cells": {
            name: {
                "success": [100.0 * float(each.mean()) for each in arms[name]],
                "effect": [effect.value, *effect.interval, effect.sign],
            }
            for name, effect in effects.items()
        },
    }
    Path(__file__).with_name("map.json").write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
