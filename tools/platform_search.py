"""Search for the planner settings of the quadrotor, on the selection library, baselines only.

    python tools/platform_search.py --scenes 20 --out docs/design/platform-search.json

The paper's planner weights are unreleased. What may be matched are quantities of the platform
(the claims marked `platform`): success, time and how much the coupled calibration error hurts a
baseline. No repair flies here, and no held-out scene. `docs/design/platform.md` says what was
tried and why the frozen settings were chosen.
"""

import argparse
import itertools
import json
import os
from functools import partial
from pathlib import Path
from statistics import median

import torch

from faultpath.execution.attempt import Done, attempt
from faultpath.faults import parse_fault
from faultpath.quadrotor.options import PlannerSettings, QuadrotorOptions
from faultpath.quadrotor.system import Quadrotor
from faultpath.trials import Arm
from faultpath.work import local, run_all

# name: (variant, options, fault). All are baselines: no wind is reconstructed, nothing is repaired.
_ANALYTIC = {"predictor": "dki-drag", "clearance": "true"}
ANALYTIC = {
    "free-space": ("zero-wind", {**_ANALYTIC, "environment": "free-space"}, None),
    "nominal": ("zero-wind", _ANALYTIC, None),
    "e=+0.1": ("zero-wind", _ANALYTIC, "calibration=+0.1"),
    "e=-0.1": ("zero-wind", _ANALYTIC, "calibration=-0.1"),
    "zero-wind L3": ("zero-wind", {**_ANALYTIC, "wind": "L3"}, None),
    "true-wind L3": ("true-wind", {**_ANALYTIC, "wind": "L3"}, None),
}
LEARNED = {
    "free-space": ("wm-a", {"environment": "free-space"}, None),
    "nominal": ("wm-a", {}, None),
    "true clearance": ("wm-a", {"clearance": "true"}, None),
    "e=+0.1": ("wm-a", {}, "calibration=+0.1"),
    "e=-0.1": ("wm-a", {}, "calibration=-0.1"),
    "zero-wind L3": ("wm-a-wind/zero-wind", {"wind": "L3"}, None),
    "true-wind L3": ("wm-a-wind/true-wind", {"wind": "L3"}, None),
    "dki": ("dki", {}, None),
    "true-parameter": ("true-parameter", {}, None),
}
MODELS = {"analytic": ANALYTIC, "learned": LEARNED}

GRID = {
    "temperature": [0.03, 0.06, 0.12],
    "rate_sigma": [0.5, 1.0],
    "rate_effort": [0.3, 1.0, 3.0],
    "margin_m": [0.1, 0.25],
}


def settings(temperature: float, rate_sigma: float, rate_effort: float, margin_m: float, **fixed):
    """Return planner settings of one grid point."""
    base = PlannerSettings()
    weights = {"rate_effort": rate_effort, "margin_m": margin_m, **fixed}
    sigma = (rate_sigma, rate_sigma, 0.4 * rate_sigma)
    return base.model_copy(
        update={
            "temperature": temperature,
            "sampler": base.sampler.model_copy(update={"rate_sigma_radps": sigma}),
            "terminal": base.terminal.model_copy(update=weights),
            "running": base.running.model_copy(update=weights),
        }
    )


def fly(job):
    """Fly one cell of one grid point; return its counts."""
    models, point, planner, cell, count = job
    torch.set_num_threads(1)
    variant, options, fault = MODELS[models][cell]
    parsed_options = QuadrotorOptions.parse(planner=planner, **options)
    system = Quadrotor(parsed_options.model_copy(update={"settings": settings(**point)}))
    scenes = [scene.id for scene in system.library("selection").scenes[:count]]
    faults = ()
    if fault:
        parsed = parse_fault(fault, system.interface, system.fault_presets, system.control_dt_s)
        faults = parsed.resolved(system.interface, system.variants[variant].consumers)
    outcomes = []
    for start in range(0, count, system.block_size):
        block = scenes[start : start + system.block_size]
        reply = attempt(system, Arm(variant=variant, faults=faults), block)
        if not isinstance(reply, Done):
            raise RuntimeError(f"{cell} cannot be flown: {reply}")
        outcomes += reply.outcomes
    times = [o.time_s for o in outcomes if o.status == "success"]
    return {
        "models": models,
        "point": point,
        "planner": planner,
        "cell": cell,
        "scenes": count,
        **{s: sum(o.status == s for o in outcomes) for s in ("success", "crash", "timeout")},
        "median_time_s": round(median(times), 2) if times else None,
    }


def main() -> None:
    """Fly the grid and write every count."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=20)
    parser.add_argument("--planners", default="terminal")
    parser.add_argument("--models", choices=MODELS, default="learned")
    parser.add_argument("--cells", help="comma-separated; default: all of the models")
    parser.add_argument("--grid", type=json.loads, default=GRID, help="JSON: name to values")
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    cells = args.cells.split(",") if args.cells else list(MODELS[args.models])
    points = [dict(zip(args.grid, v, strict=True)) for v in itertools.product(*args.grid.values())]
    jobs = [
        (args.models, point, planner, cell, args.scenes)
        for point in points
        for planner in args.planners.split(",")
        for cell in cells
    ]
    done = json.loads(args.out.read_text()) if args.out.exists() else []
    known = {
        json.dumps([d[k] for k in ("models", "point", "planner", "cell", "scenes")]) for d in done
    }
    jobs = [job for job in jobs if json.dumps(list(job)) not in known]
    import platform_search  # a worker finds functions of a module, not those of a script

    calls = [partial(platform_search.fly, job) for job in jobs]
    with local(os.cpu_count() or 1) as executor:
        for number, (_, result) in enumerate(run_all(executor, calls), 1):
            done.append(result)
            args.out.write_text(json.dumps(done, indent=1) + "\n")
            print(f"{number}/{len(jobs)}", json.dumps(result), flush=True)


if __name__ == "__main__":
    main()
