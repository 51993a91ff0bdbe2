"""Fly the rooms of one camera under its faults, decide, and write what was found.

    python experiments/latent-camera/study.py DESIGN.yaml --library selection --scenes 40

Everything is kept in --out and the same command resumes: a treatment that one repair needs is there
for the next. Writes what was decided to `<design>-<library>.json` there.
"""

import argparse
import json
from dataclasses import dataclass
from pathlib import Path

import yaml

from faultpath.analyses.contrasts import compared
from faultpath.analyses.family import TestedContrasts, decide_conditions
from faultpath.analyses.model import CORRECT, SHARED
from faultpath.faults import at_readers
from faultpath.run.execution.runner import run_plan
from faultpath.run.pairing import Group, pair
from faultpath.run.plan import Plan, Row, SystemSpec, Treatment
from faultpath.run.registry import load_system
from faultpath.run.trials import Trials
from faultpath.system import Status

ROOT = Path(__file__).resolve().parents[2]
OBSERVATION, GOAL = "observation", "goal"
CONDITIONS = (OBSERVATION, GOAL, SHARED)


@dataclass(frozen=True)
class Design:
    """What is flown."""

    options: dict[str, str]
    baseline: str
    repairs: tuple[str, ...]
    faults: dict[str, str]
    seeds: tuple[int, ...]
    scenes: int

    @classmethod
    def read(cls, path: Path) -> "Design":
        """Return the design in a file."""
        return cls(
            **{name: _frozen(value) for name, value in yaml.safe_load(path.read_text()).items()}
        )

    @property
    def spec(self) -> SystemSpec:
        """How the system is built."""
        return SystemSpec(name=f"{ROOT / 'examples/latent_camera.py'}:create", options=self.options)


def _frozen(value):
    return tuple(value) if isinstance(value, list) else value


def plan_of(design: Design, repair: str, library: str, scenes: tuple[str, ...]) -> Plan:
    """Return the treatments of the baseline and one repair under every fault."""
    system, rows = load_system(design.spec), []
    for seed in design.seeds:
        for variant in (design.baseline, repair):
            readers = system.variants[variant].readers
            conditions: dict[str, tuple] = {CORRECT: ()}
            for name, text in design.faults.items():
                for condition in CONDITIONS:
                    fault = system.fault(text if condition == SHARED else f"{text}@{condition}")
                    conditions[f"{name}/{condition}"] = at_readers(fault, readers)
            for condition, faults in conditions.items():
                treatment = Treatment(variant=variant, faults=faults, seed=seed)
                rows.append(
                    Row(variant=variant, condition=condition, seed=seed, treatment=treatment)
                )
    return Plan(
        name="latent-camera",
        system=design.spec,
        library=library,
        scenes=scenes,
        rows=tuple(rows),
    )


def decided(design: Design, repair: str, table: Trials) -> list[dict]:
    """Return the audit of a repair under each fault; a design errs in at most 5 %."""
    found = []
    for fault in design.faults:
        conditions = {CORRECT: CORRECT} | {
            condition: f"{fault}/{condition}" for condition in CONDITIONS
        }
        outcomes = compared(repair, design.baseline, conditions.values(), table).success
        success = {name: outcomes[condition] for name, condition in conditions.items()}
        alpha = 0.05 / (len(design.faults) * len(design.repairs))
        family = decide_conditions(success, alpha=alpha)
        found.append({"fault": fault, "repair": repair, **_said(success, family)})
    return found


def cancelled(design: Design, table: Trials) -> list[dict]:
    """Return, of the baseline, success with the fault shared against the observation alone."""
    success = {}
    for fault in design.faults:
        both = pair(
            table,
            Group(design.baseline, f"{fault}/{SHARED}"),
            Group(design.baseline, f"{fault}/{OBSERVATION}"),
        )
        success[fault] = both.whole().ended(Status.SUCCESS)
    said = _said(success, decide_conditions(success))
    return [
        {"fault": fault, "success": said["success"][fault], "effect": said["effects"][fault]}
        for fault in success
    ]


def _said(success, family: TestedContrasts) -> dict:
    return {
        "success": {
            name: [float(treatment.mean()) for treatment in treatments]
            for name, treatments in success.items()
        },
        "effects": {
            name: [round(effect.value, 2), *(round(end, 2) for end in effect.interval), effect.sign]
            for name, effect in family.effects.items()
        },
        "turns": dict(family.turns),
    }


def main() -> None:
    """Fly and decide."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("design", type=Path)
    parser.add_argument("--library", required=True)
    parser.add_argument("--scenes", type=int)
    parser.add_argument("--repairs", help="Only these of the design, comma-separated.")
    parser.add_argument("--out", type=Path, default=Path("runs/latent-camera-study"))
    parser.add_argument("--workers", type=int, default=1)
    asked = parser.parse_args()
    design = Design.read(asked.design)
    library = load_system(design.spec).library(asked.library)
    scenes = tuple(scene.id for scene in library.scenes[: asked.scenes or design.scenes])
    repairs = tuple(asked.repairs.split(",")) if asked.repairs else design.repairs
    stem = f"{asked.design.stem}-{asked.library}"
    audits, baseline = [], []
    for repair in repairs:
        result = run_plan(
            plan_of(design, repair, asked.library, scenes),
            asked.out / stem,
            asked.workers,
            lambda now: print(f"\r{now.done:g}/{now.total:g}", end="", flush=True),
            print,
            shared=True,
        )
        audits += decided(design, repair, result.trials)
        baseline = cancelled(design, result.trials)
        found = {
            "library": asked.library,
            "scenes": len(scenes),
            "seeds": list(design.seeds),
            "faults": design.faults,
            "baseline": baseline,
            "audits": audits,
        }
        (asked.out / f"{stem}.json").write_text(json.dumps(found, indent=1) + "\n")
        print("\n", repair, flush=True)
        for audit in audits[-len(design.faults) :]:
            print("  ", audit["fault"])
            for name, (value, low, high, sign) in audit["effects"].items():
                one, two = audit["success"][name]
                turn = audit["turns"].get(name, "")
                ends = f"[{low:+.1f}, {high:+.1f}]"
                print(f"    {name:12s} {two:.3f} -> {one:.3f} {value:+.1f} {ends} {sign} {turn}")
    for each in baseline:
        print("   plain, shared against observation alone:", each, flush=True)


if __name__ == "__main__":
    main()
