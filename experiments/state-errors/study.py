"""Fly the faults of sensors: shared through the filter, and as recorded errors at one consumer.

    python experiments/state-errors/study.py DESIGN.yaml --library selection --scenes 40

Everything is kept in --out and the same command resumes. Prints the decisions, and writes
`found.json` there.
"""

import argparse
import json
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
import yaml
from faultpath_quadrotor.state_errors import TURNING, state_errors

from faultpath.decisions.family import compared, decide_paths
from faultpath.decisions.model import CORRECT, SHARED
from faultpath.faults import Address, encode_record, parse_fault, resolve
from faultpath.faults.recorded import decode_record
from faultpath.trials import Arm, OutcomeTable, Row, Study, SystemSpec, load_system
from faultpath.trials.execution.runner import run_study
from faultpath.trials.store.atomic import write

BLOCK = 25


@dataclass(frozen=True)
class Design:
    """What is flown."""

    spec: SystemSpec
    baseline: str
    repairs: dict[str, tuple[str, str]]
    faults: dict[str, str]
    places: dict[str, str]
    seed: int
    audits: tuple[tuple[str, str], ...]
    """Fault and repair."""

    @classmethod
    def read(cls, path: Path) -> "Design":
        """Return the design in a file."""
        given = yaml.safe_load(path.read_text())
        repairs = {name: tuple(each) for name, each in given["repairs"].items()}
        every = [(fault, repair) for fault in given["faults"] for repair in repairs]
        audits = tuple(map(tuple, given.get("audits", every)))
        spec = SystemSpec(name="quadrotor", options=given["options"])
        places, seed = given["places"], given["seed"]
        return cls(spec, given["baseline"], repairs, given["faults"], places, seed, audits)

    @property
    def own(self) -> str:
        """The filter of the baseline."""
        return self.spec.options["estimator"]

    def variants(self, fault: str) -> dict[str, str]:
        """The filter of each variant that meets a fault."""
        met = [self.repairs[repair] for each, repair in self.audits if each == fault]
        return {self.baseline: self.own, **dict(met)}


def record(
    design: Design, fault: str, filter_: str, library: str, scenes: tuple[str, ...], part: Path
) -> None:
    """Fly the baseline with a filter under the fault of a sensor; keep the filter's errors."""
    torch.set_num_threads(1)
    system = load_system(design.spec)
    system.library(library)
    variant = design.baseline if filter_ == design.own else f"{filter_}/{design.baseline}"
    faults = [_fault(system, design.faults[fault])]
    found = state_errors(system, variant, scenes, design.seed, faults)
    write(part, encode_record(found, TURNING), part.parent)


def records(
    design: Design, library: str, scenes: tuple[str, ...], out: Path
) -> dict[tuple[str, str], Path]:
    """Return the file of each fault's and filter's errors, made where it is missing."""
    out.mkdir(parents=True, exist_ok=True)
    wanted = {(f, each) for f, _ in design.audits for each in design.variants(f).values()}
    blocks = [scenes[at : at + BLOCK] for at in range(0, len(scenes), BLOCK)]
    files, jobs = {}, []
    with ProcessPoolExecutor(2) as pool:
        for fault, filter_ in sorted(wanted):
            stem = f"{fault}-{filter_}-{len(scenes)}".replace(" ", "-")
            files[fault, filter_] = [out / f"{stem}.{i}.parquet" for i in range(len(blocks))]
            for block, part in zip(blocks, files[fault, filter_], strict=True):
                if not part.is_file():
                    jobs.append(pool.submit(record, design, fault, filter_, library, block, part))
        for done, job in enumerate(as_completed(jobs), 1):
            job.result()
            print(f"recorded {done}/{len(jobs)}", flush=True)
    whole = {}
    for (fault, filter_), parts in files.items():
        whole[fault, filter_] = parts[0].with_name(parts[0].name.replace(".0.", "."))
        if not whole[fault, filter_].is_file():
            merged = {}
            for part in parts:
                for channel, rows in decode_record(part.read_bytes(), str(part)).items():
                    for (scene, seed), (_, errors) in rows.items():
                        merged[channel, scene, seed] = errors
            data = encode_record({Address(*key): each for key, each in merged.items()}, TURNING)
            write(whole[fault, filter_], data, out)
    return whole


def study(design: Design, library: str, scenes: tuple[str, ...], files) -> Study:
    """Return every arm: nominal, shared and at each place, of all variants."""
    system, rows = load_system(design.spec), {}

    def add(variant: str, path: str, *faults) -> None:
        consumers = system.variants[variant].consumers
        found = [p for f in faults for p in f.resolved(system.interface, consumers)]
        arm = Arm(
            variant=variant, faults=resolve(found, system.interface, consumers), seed=design.seed
        )
        rows[variant, path] = Row(variant=variant, path=path, seed=design.seed, arm=arm)

    for fault, _ in design.audits:
        for variant, filter_ in design.variants(fault).items():
            add(variant, CORRECT)
            add(variant, f"{fault}/{SHARED}", _fault(system, design.faults[fault]))
            for name, place in design.places.items():
                text = f"state:recorded={files[fault, filter_]}@{place}"
                add(variant, f"{fault}/{name}", _fault(system, text))
    return Study(
        name="state-errors",
        system=design.spec,
        library=library,
        scenes=scenes,
        rows=tuple(rows.values()),
    )


def sizes(files: dict[tuple[str, str], Path]) -> list[dict]:
    """Return the root mean square length of the errors that each file delivers, by channel."""
    found = []
    for (fault, filter_), path in files.items():
        rms = {}
        for channel, rows in decode_record(path.read_bytes(), str(path)).items():
            errors = np.concatenate([errors for _, errors in rows.values()]).astype(np.float64)
            if channel in TURNING:  # of a rotation, its angle in degrees
                traces = errors.reshape(-1, 3, 3).trace(axis1=1, axis2=2)
                errors = np.degrees(np.arccos(np.clip((traces - 1.0) / 2.0, -1.0, 1.0)))[:, None]
            rms[channel] = float(np.sqrt(np.mean((errors**2).sum(1))))
        found.append({"fault": fault, "filter": filter_, "rms": rms})
    return found


def _fault(system, text: str):
    return parse_fault(text, system.interface, system.fault_presets, system.control_dt_s)


def decided(design: Design, table: OutcomeTable) -> list[dict]:
    """Return what each audit decides; all of them together err in one of twenty studies."""
    found = []
    for fault, repair in design.audits:
        paths = {CORRECT: CORRECT, SHARED: f"{fault}/{SHARED}"}
        paths |= {name: f"{fault}/{name}" for name in design.places}
        arms = compared(design.repairs[repair][0], design.baseline, paths.values(), table).arms
        success = {name: arms[path] for name, path in paths.items()}
        family = decide_paths(success, rule="unconditional", alpha=0.05 / len(design.audits))
        found.append(
            {
                "fault": fault,
                "repair": repair,
                "success": {n: [float(np.mean(a)) for a in pair] for n, pair in success.items()},
                "effects": {n: [e.value, *e.interval, e.sign] for n, e in family.effects.items()},
                "turns": dict(family.turns),
            }
        )
    return found


def main() -> None:
    """Fly and decide."""
    parser = argparse.ArgumentParser()
    parser.add_argument("design", type=Path)
    parser.add_argument("--library", required=True)
    parser.add_argument("--scenes", type=int)
    parser.add_argument("--out", type=Path, default=Path("runs/state-errors"))
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    design = Design.read(asked.design)
    library = load_system(design.spec).library(asked.library)
    name = Path(asked.library).stem
    scenes = tuple(scene.id for scene in library.scenes[: asked.scenes])
    out = asked.out / name
    files = records(design, asked.library, scenes, out / "errors")
    (out / "errors.json").write_text(json.dumps(sizes(files), indent=1) + "\n")
    asks = study(design, asked.library, scenes, files)
    print(len(asks.arms()), "arms", len(scenes), "scenes", flush=True)

    def shown(now) -> None:
        print(f"\r{now.done:g}/{now.total:g}", end="", flush=True)

    result = run_study(asks, out / "run", asked.workers, shown, print)
    found = decided(design, result.outcomes)
    (out / "found.json").write_text(json.dumps(found, indent=1) + "\n")
    for each in found:
        print("\n", each["fault"], "|", each["repair"])
        for name, (value, low, high, sign) in each["effects"].items():
            one, two = each["success"][name]
            said = each["turns"].get(name, "")
            ends = f"[{low:+.1f}, {high:+.1f}]"
            print(f"  {name:15s} {one:.2f} {two:.2f} {value:+.1f} {ends} {sign} {said}")


if __name__ == "__main__":
    main()
