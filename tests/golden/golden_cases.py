"""Cases whose numbers may not change by a bit, asked through what a user calls.

`python tests/golden/golden_cases.py` writes them to `numbers.json`: only where a change of numbers
is meant, and then the commit says why. It runs itself with the code that NumPy, OpenBLAS and the C
library have for every x86-64 processor, so that no newer instructions change a last bit. How a
result is laid out may change: only `of_record`, `of_map` and `of_paper` know of that.
"""

import hashlib
import json
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

import faultpath

EVERYWHERE = {
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F,-AVX512VL",
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
    "OPENBLAS_CORETYPE": "Nehalem",
    "OMP_NUM_THREADS": "1",
}
"""Read by libraries when a process starts."""
PAPER = find_spec("faultpath_paper") is not None
"""The engine's tests run without it under other Pythons."""
HERE = Path(__file__).resolve().parent
NUMBERS = HERE / "numbers.json"
SYSTEM = f"{HERE.parent / 'toys' / 'weighed.py'}:golden"
HEADER = "variant,scene,seed,task,condition,success,initial\n"

FAILED = "once/s003/0,twice/s004/1,twice/s003/1,once/s010/0,once/s010/1"
MASS = {"baseline": "once", "repair": "twice", "fault": "mass:scale=0.9"}
SEEDS = (0, 1, 2, 3, 4)
AUDITS: dict[str, dict[str, Any]] = {
    "one seed": {**MASS},
    "many seeds with ties": {**MASS, "scenes": 60, "seeds": SEEDS},
    "newly trained models": {**MASS, "scenes": 60, "seeds": SEEDS, "generalise": "models"},
    "failed trials": {**MASS, "scenes": 40, "seeds": (0, 1), "options": {"fails": FAILED}},
    "failed trials of one seed": {**MASS, "scenes": 40, "options": {"fails": FAILED}},
    "a failed training": {
        **MASS,
        "scenes": 20,
        "seeds": SEEDS,
        "generalise": "models",
        "options": {"fails": FAILED},
    },
    "three modules and thresholds": {
        "baseline": "once",
        "repair": "thrice",
        "fault": "mass:scale=1.1",
        "metric": "distance",
        "thresholds": (0.05, 0.1),
        "primary": "limit",
    },
    "a fault that one version does not read": {
        "baseline": "once",
        "repair": "twice",
        "fault": "mass:scale=0.9@observer",
    },
    "stopped": {**MASS, "stop_when": "decided"},
    "all decided or small": {
        "baseline": "twice",
        "repair": "thrice",
        "fault": "mass:scale=1.05",
        "stop_when": "all-decided",
        "margin_pp": 20.0,
    },
    "never stopped": {**MASS, "fault": "mass:scale=0.99", "stop_when": "decided", "scenes": 20},
    "few scenes": {**MASS, "scenes": 4},
}
MAPS: dict[str, dict[str, Any]] = {
    "map over several rounds": {"scenes": 20, "spread": (0.15,), "correlation": 0.3},
    "map with seeds and a failed trial": {
        "scenes": 6,
        "seeds": (0, 1),
        "points": 27,
        "spread": (0.1, 0.2),
        "mean": (0.05,),
        "options": {"fails": "twice/s003/1"},
    },
}

JUDGED: dict[str, dict[str, Any]] = {
    "keys": {"drop": ["initial"]},
    "hashes": {},
    "tasks": {"cluster": "task", "scenes": 60},
    "tasks and seeds": {"cluster": "task", "seeds": 3},
    "seeds": {"seeds": 4},
    "models": {"seeds": 5, "generalise": "models"},
    "one condition": {"conditions": ("nominal",), "scenes": 150},
    "no condition": {"drop": ["condition"], "conditions": ("nominal",)},
    "primary": {"primary": "planner"},
    "failed in both versions": {"seeds": 2, "failed": {"new": 0.05, "old": 0.08}},
    "failed in the new version": {"failed": {"new": 0.15}},
    "missing in both versions": {"seeds": 2, "missing": {"new": 0.06, "old": 0.03}},
    "missing in the old version": {"missing": {"old": 0.2}},
    "one training failed in part": {
        "seeds": 5,
        "generalise": "models",
        "failed": {"new": 0.02},
    },
    "mismatched": {"unlike": True},
    "few": {"scenes": 3},
    "failed trials that could undo it": {"scenes": 40, "failed": {"new": 0.1, "old": 0.1}},
}
RATES = {
    ("old", "nominal"): 0.6,
    ("new", "nominal"): 0.55,
    ("old", "observer"): 0.35,
    ("new", "observer"): 0.65,
    ("old", "planner"): 0.5,
    ("new", "planner"): 0.55,
    ("old", "shared"): 0.6,
    ("new", "shared"): 0.3,
}


def results_of(
    file: Path,
    number: int,
    scenes: int = 80,
    seeds: int = 1,
    conditions: tuple[str, ...] = ("nominal", "observer", "planner", "shared"),
    failed: dict[str, float] | None = None,
    missing: dict[str, float] | None = None,
    unlike: bool = False,
    drop: tuple[str, ...] = (),
) -> None:
    """Write trials of two versions as another tool would."""
    draw = np.random.Generator(np.random.PCG64(1000 + number))
    columns = [name for name in HEADER.strip().split(",") if name not in drop]
    lines = [",".join(columns)]
    hardness = draw.uniform(size=scenes)
    for condition in conditions:
        for variant in ("old", "new"):
            for seed in range(seeds):
                for scene in range(scenes):
                    chance, fails, misses = draw.uniform(size=3)
                    won = 0.5 * hardness[scene] + 0.5 * chance < RATES[variant, condition]
                    cells = {
                        "variant": variant,
                        "scene": f"s{scene}",
                        "seed": seed,
                        "task": f"t{scene % 12}",
                        "condition": condition,
                        "success": int(won),
                        "initial": f"h{scene}",
                    }
                    if fails < (failed or {}).get(variant, 0.0):
                        cells["success"] = "failed"
                    if unlike and scene == 7 and variant == "new":
                        cells["initial"] = "other"
                    if misses >= (missing or {}).get(variant, 0.0):
                        lines.append(",".join(str(cells[name]) for name in columns))
    file.write_text("\n".join(lines) + "\n")


FILE_ONLY = ("scenes", "seeds", "conditions", "failed", "missing", "unlike", "drop")


def cases(folder: Path) -> Iterator[tuple[str, Callable[[], dict[str, Any]]]]:
    """Yield the name of each case, and what computes its numbers in a folder of its own."""
    quiet: dict[str, Any] = {"library": "any", "progress": False, "workers": 0}

    def audit(place: Path, question: dict[str, Any]) -> dict[str, Any]:
        run = faultpath.audit(SYSTEM, folder=place, signals=False, **quiet, **question)
        return of_record(run.record)

    def reversal_map(place: Path, question: dict[str, Any]) -> dict[str, Any]:
        about = {"baseline": "once", "repair": "twice", "fault": "mass", "up_to": 0.4}
        about |= {"against": "planner,observer", "points": 40, **quiet, **question}
        return of_map(faultpath.map(SYSTEM, folder=place, **about).record)

    def judge(place: Path, number: int, case: dict[str, Any]) -> dict[str, Any]:
        file = place.with_suffix(".csv")
        results_of(file, number, **{name: case[name] for name in FILE_ONLY if name in case})
        question = {name: value for name, value in case.items() if name not in FILE_ONLY}
        run = faultpath.judge(
            file, baseline="old", repair="new", folder=place, progress=False, **question
        )
        return of_record(run.record)

    for number, (name, question) in enumerate(AUDITS.items()):
        yield f"audit: {name}", lambda n=number, q=question: audit(folder / f"audit-{n}", q)
    for number, (name, question) in enumerate(MAPS.items()):
        yield name, lambda n=number, q=question: reversal_map(folder / f"map-{n}", q)
    for number, (name, case) in enumerate(JUDGED.items()):
        yield f"judge: {name}", lambda n=number, c=case: judge(folder / f"judged-{n}", n, c)
    if PAPER:
        yield "paper", of_paper


def of_record(record: Any) -> dict[str, Any]:
    """Return the numbers and decisions of an audit, without its words."""
    result = record.model_dump(mode="json")
    effects = {
        effect.condition: {
            "success": of_difference(effect),
            "sign": effect.sign,
            "test": effect.test,
            "p_value": effect.p_value,
            "adjusted_p_value": effect.corrected_p,
            "mcnemar_p_value": effect.mcnemar_p,
            "scenes": effect.scenes,
            "ahead": effect.ahead,
            "void_pairs": effect.void,
            "failed": of_missing(effect.missing),
            "wins": [won for won, _ in effect.won],
            "losses": [lost for _, lost in effect.won],
            "baseline_percent": effect.rates[0],
            "repair_percent": effect.rates[1],
            "extreme": effect.extreme,
            "minimum_detectable_pp": effect.least_pp,
            "joint_successes": secondary["joint_successes"],
            "metric_means": secondary["metric_means"],
            "metrics": {name: estimate(value) for name, value in secondary["metrics"].items()},
            "time_s": estimate(secondary["time_s"]),
            "thresholds": [
                [*(at[name] for name in _OF_A_THRESHOLD), *estimate(at["difference"])]
                for at in secondary["thresholds"]
            ],
        }
        for effect, secondary in zip(record.effects, result["secondary"], strict=True)
    }
    changes = {
        f"{change.isolated} to shared": {
            "change": of_difference(change),
            "sign": change.sign,
            "test": change.test,
            "p_value": change.p_value,
            "adjusted_p_value": change.corrected_p,
            "unsettled": change.unsettled,
            "turn": change.turn,
        }
        for change in record.changes
    }
    even = {
        name: {
            entry["condition"]: {
                **{key: entry["result"][key] for key in ("p_star", "pieces", "kind", "regions")},
                "curve": digest(entry["curve"]),
            }
            for entry in result["break_evens"]
            if entry["over"] == over
        }
        for name, over in (("break_even", "frequency"), ("break_even_beta", "beta"))
    }
    cells = {
        f"{cell['variant']}, {cell['condition']}": [cell[name] for name in _OF_A_CELL]
        for cell in result["counts"]
    }
    whole = {name: result[name] for name in ("scenes", "invalid", "stopped")}
    whole["scenes_needed"] = result["testing"]["scenes_needed"]
    return {**whole, "effects": effects, "changes": changes, **even, "cells": cells}


_OF_A_THRESHOLD = ("threshold", "baseline_percent", "repair_percent")
_OF_A_CELL = ("trials", "success", "crash", "timeout", "failed", "median_time_s")


def of_map(record: Any) -> dict[str, Any]:
    """Return the numbers and decisions of a map, without its words."""
    result = record.model_dump(mode="json")
    joint = result["joint"]
    return {
        **{name: result[name] for name in ("scenes", "invalid", "critical", "failed")},
        "points": [list(point.values()) for point in result["points"]],
        "surface": digest([result["surface"]["difference"], result["surface"]["sign"]]),
        "flips": [list(flip.values()) for flip in result["flips"]],
        "curve": curve(joint["curve"]),
        "asked": joint["requested"],
        **{name: joint[name] for name in ("estimates", "undecided", "regions")},
        **{f"joint {name}": joint[name] for name in ("outside", "critical")},
    }


def of_paper() -> dict[str, Any]:
    """Return what the claims of the paper come to in a run that is made up."""
    sys.path += [str(HERE.parent), str(HERE.parent / "paper")]
    from faultpath_paper.claims import evaluate
    from study_toys import whole

    return {
        claim.id: [
            claim.verdict,
            *(
                [part.answer, part.estimate, part.interval, part.score, part.p_value, part.mde]
                for part in claim.parts
            ),
        ]
        for claim in evaluate(whole())
    }


def of_difference(of: Any) -> list[Any]:
    """Return a difference with its interval."""
    return [of.value, of.low, of.high, of.scenes, len(of.per_seed), of.per_seed]


def of_missing(missing: Any) -> dict[str, Any] | None:
    """Return the bounds that trials leave open, where some failed."""
    if missing is None or missing.against_pp is None:
        return None
    return {name: value for name, value in missing.model_dump().items() if name != "void"}


def estimate(value: dict[str, Any] | None) -> list[Any]:
    """Return an estimate with its interval."""
    names = ("value", "low", "high", "n_scenes", "n_seeds", "per_seed")
    return [] if value is None else [value[name] for name in names]


def digest(numbers: object) -> str:
    """Return a hash of numbers that are too many to store."""
    return hashlib.sha256(json.dumps(numbers).encode()).hexdigest()[:16]


def curve(points: list[dict[str, float]]) -> str:
    """Return a hash of a curve, but for the last bits, which differ between versions of SciPy."""
    return digest(np.round([list(point.values()) for point in points], 10).tolist())


def plain(numbers: object) -> Any:
    """Return numbers as JSON holds them: a float keeps every bit, a tuple becomes a list."""
    return json.loads(json.dumps(numbers))


def main(target: Path = NUMBERS) -> None:
    """Write the numbers of all cases; their pages, which hold no others, are left out."""
    pages = patch("faultpath.api.runs.write_report", lambda *_: [])
    disk = patch("os.fsync", lambda _: None)  # waiting for it would take most of the time
    with pages, disk, tempfile.TemporaryDirectory() as folder:
        numbers = {name: plain(compute()) for name, compute in cases(Path(folder))}
    lines = (f"{json.dumps(name)}: {json.dumps(of)}" for name, of in numbers.items())
    target.write_text("{\n" + ",\n".join(lines) + "\n}\n")


if __name__ == "__main__":
    if not EVERYWHERE.items() <= os.environ.items():
        os.execve(sys.executable, [sys.executable, *sys.argv], os.environ | EVERYWHERE)
    main(*map(Path, sys.argv[1:]))
