"""Fly faults of sensors: shared through the filter, and as recorded errors at one module.

    python experiments/state-errors/state_study.py [--out FOLDER] [--scenes N] [--workers N]

The same command resumes. What the folder holds then, `tools/documents.py --take
state-errors=FOLDER` makes the tables of docs/state-errors.md from.
"""

import argparse
import shutil
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import chdir
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import torch
from faultpath_quadrotor.state_errors import TURNING, state_errors
from state_design import Audit, Design, ErrorSize, SensorAudits

from faultpath.analyses.contrasts import compared
from faultpath.analyses.family import decide_conditions
from faultpath.analyses.model import CORRECT, SHARED
from faultpath.api.display import Display, SafeConsole
from faultpath.api.systems import executor_of
from faultpath.core.errors import Stopped, UserError
from faultpath.core.files.atomic import make_folder, write, write_text
from faultpath.faults import Address, at_readers, encode_record
from faultpath.faults.recorded import decode_record
from faultpath.report.sentences.findings import describe
from faultpath.run.execution.runner import run_plan
from faultpath.run.plan import Plan, Row, Treatment
from faultpath.run.provenance import run_provenance
from faultpath.run.registry import load_system
from faultpath.run.trials import Trials
from faultpath.system import library_of

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
AUDITS, OUTCOMES = "audits.json", "outcomes.parquet"
BLOCK = 25
Files = Mapping[tuple[str, str], Path]
"""A file of errors for each fault and filter."""


def record(design: Design, fault: str, estimator: str, scenes: Sequence[str], file: Path) -> None:
    """Fly the baseline with a filter under the fault of a sensor; keep the filter's errors."""
    torch.set_num_threads(1)
    system = load_system(design.spec)
    library_of(system, design.library)
    own = estimator == design.options["estimator"]
    variant = design.baseline if own else f"{estimator}/{design.baseline}"
    errors = state_errors(system, variant, scenes, design.seed, system.fault(fault))
    write(file, encode_record(errors, TURNING), file.parent)


def recorded(
    design: Design, scenes: Sequence[str], folder: Path, workers: int, show: Display
) -> Files:
    """Return the errors of each filter under each fault that it meets, made where not kept."""
    pairs = {(fault, f) for fault, filters in design.variants.items() for f in filters.values()}
    blocks = [scenes[at : at + BLOCK] for at in range(0, len(scenes), BLOCK)]
    files, jobs = dict[tuple[str, str], Path](), []
    with ProcessPoolExecutor(workers) as pool:
        for fault, estimator in sorted(pairs):
            stem = f"{fault}-{estimator}-{len(scenes)}".replace(" ", "-")
            files[fault, estimator] = folder / f"{stem}.parquet"
            for index, block in enumerate(blocks):
                part = folder / f"{stem}.{index}.parquet"
                if not part.is_file():
                    task = (record, design, design.faults[fault], estimator, block, part)
                    jobs.append(pool.submit(*task))
        for done, job in enumerate(as_completed(jobs), 1):
            job.result()
            show.say(f"Recorded {done} of {len(jobs)} blocks of errors.")
    for whole in files.values():
        parts = [whole.with_suffix(f".{index}.parquet") for index in range(len(blocks))]
        write(whole, joined(parts), folder)
    return files


def joined(parts: Sequence[Path]) -> bytes:
    """Return the errors of several files as one."""
    errors = {
        Address(channel, *trial): values
        for part in parts
        for channel, trials in decode_record(part.read_bytes(), str(part)).items()
        for trial, (_, values) in trials.items()
    }
    return encode_record(errors, TURNING)


def plan_of(design: Design, system, scenes: Sequence[str], files: Files) -> Plan:
    """Return all that flies: without a fault, with it shared, and with its errors at one module."""
    rows: dict[tuple[str, str], Row] = {}
    for fault, filters in design.variants.items():
        for variant, estimator in filters.items():
            errors = f"state:recorded={files[fault, estimator]}"
            texts = {CORRECT: "", f"{fault}/{SHARED}": design.faults[fault]}
            texts |= {f"{fault}/{name}": f"{errors}@{at}" for name, at in design.modules.items()}
            readers = system.variants[variant].readers
            for condition, text in texts.items():
                faults = at_readers(system.fault(text), readers) if text else ()
                treatment = Treatment(variant=variant, faults=faults, seed=design.seed)
                rows[variant, condition] = Row(
                    variant=variant, condition=condition, seed=design.seed, treatment=treatment
                )
    return Plan(
        name="state-errors",
        system=design.spec,
        library=design.library,
        scenes=tuple(scenes),
        rows=tuple(rows.values()),
    )


def decided(design: Design, table: Trials) -> tuple[Audit, ...]:
    """Return what is significant in each audit; all of them err in one of twenty studies."""
    audits = list[Audit]()
    for fault, repair in design.audits:
        conditions = {name: f"{fault}/{name}" for name in (SHARED, *design.modules)} | {
            CORRECT: CORRECT
        }
        outcomes = compared(
            design.repairs[repair][0], design.baseline, conditions.values(), table
        ).success
        success = {name: outcomes[condition] for name, condition in conditions.items()}
        family = decide_conditions(success, alpha=0.05 / len(design.audits))
        audits.append(
            Audit(
                fault=fault,
                repair=repair,
                success={
                    name: (float(np.mean(one)), float(np.mean(other)))
                    for name, (one, other) in success.items()
                },
                effects={n: (e.value, *e.interval, e.sign) for n, e in family.effects.items()},
                turns=dict(family.turns),
            )
        )
    return tuple(audits)


def sizes(files: Files) -> tuple[ErrorSize, ...]:
    """Return how large the errors in each file are."""
    return tuple(
        ErrorSize(
            fault=fault,
            filter=estimator,
            rms={
                channel: size(np.concatenate([e for _, e in trials.values()]), channel in TURNING)
                for channel, trials in decode_record(file.read_bytes(), str(file)).items()
            },
        )
        for (fault, estimator), file in files.items()
    )


def size(errors: np.ndarray, turning: bool) -> float:
    """Return the root mean square length of errors `[T, N]`; of rotations, their angle."""
    errors = errors.astype(np.float64)
    if turning:
        traces = errors.reshape(-1, 3, 3).trace(axis1=1, axis2=2)
        errors = np.degrees(np.arccos(np.clip((traces - 1.0) / 2.0, -1.0, 1.0)))[:, None]
    return float(np.sqrt(np.mean((errors**2).sum(1))))


def fly(
    design: Design, folder: Path, scenes: int | None, workers: int, show: Display
) -> SensorAudits:
    """Fly everything, and write what it showed."""
    started = datetime.now(UTC)
    system = load_system(design.spec)
    chosen = tuple(scene.id for scene in library_of(system, design.library).scenes[:scenes])
    make_folder(folder)
    make_folder(folder / "errors")
    files = recorded(design, chosen, folder / "errors", workers, show)
    plan = plan_of(design, system, chosen, files)
    show.say(f"{len(plan.treatments()) * len(chosen)} trials.")
    with executor_of(system, workers) as force, show.progress("Flying") as move:
        result = run_plan(
            plan, folder / "run", progress=move, notice=show.say, system=system, executor=force
        )
    for finding in result.findings:
        show.say(describe(finding))
    audits = SensorAudits(
        design=design,
        options=design.options,
        scenes=len(chosen),
        audits=decided(design, result.trials),
        errors=sizes(files),
    )
    write_text(folder / AUDITS, audits.model_dump_json(indent=1) + "\n", folder)
    shutil.copyfile(folder / "run" / OUTCOMES, folder / OUTCOMES)
    command = ("state_study.py", *sys.argv[1:])
    run_provenance(folder, [AUDITS, OUTCOMES], result, started, command, force, system.backend)
    return audits


def main(arguments: Sequence[str] | None = None) -> int:
    """Carry out the command line; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--out", type=Path, default=Path("runs/state-errors"))
    parser.add_argument("--scenes", type=int, default=None, help="the first ones only")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args(arguments)
    if options.workers < 1:
        parser.error(f"--workers {options.workers}: give at least one")
    show = Display(SafeConsole(stderr=True), ("state_study.py", *sys.argv[1:]))
    try:
        with chdir(ROOT):  # design and errors are named as from there
            design = Design.read(HERE / "design.yaml")
            audits = fly(design, options.out, options.scenes, options.workers, show)
    except UserError as error:
        print(f"state_study.py: {error}", file=sys.stderr)
        return 130 if isinstance(error, Stopped) else 2
    for audit in audits.audits:
        print(f"{audit.fault}, {audit.repair}")
        for name, (value, low, high, sign) in audit.effects.items():
            mark = "significant" if sign else ""
            print(f"  {name:20s}{value:+6.1f} [{low:+.1f}, {high:+.1f}] {mark}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
