"""Fly where verdicts of the paper carry over, and say what was decided.

    python experiments/carry-over/study.py [--out FOLDER] [--quick] [--workers N] [--executor ray]

The same command resumes. Arms that several questions share fly once. What the folder holds then,
`tools/documents.py --take carry-over=FOLDER` makes the table of docs/carry-over.md from.
"""

import argparse
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import chdir
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

from carry_design import VOID, Cell, Design, Flown, Levels, Round
from carry_verdicts import sentences, settled

from faultpath.analyses.audit import audit_analysis
from faultpath.api.display import Display, SafeConsole
from faultpath.api.systems import executor_of
from faultpath.core.errors import Stopped, UserError
from faultpath.core.files.atomic import make_folder, write_text
from faultpath.core.text import counted
from faultpath.report.sentences.findings import describe
from faultpath.run.execution.runner import RunResult, run_plan
from faultpath.run.pairing import Group, pair
from faultpath.run.plan import Plan, Row, SystemSpec
from faultpath.run.provenance import run_provenance
from faultpath.run.question import AuditQuestion
from faultpath.run.registry import load_system
from faultpath.run.work.executor import Executor, Progress
from faultpath.system import Status, library_of

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SYSTEM = "quadrotor"
CELLS = "cells.json"


def offered(design: Design) -> tuple[Design, dict[str, str]]:
    """Return the design without the levels that the system does not offer, and why it does not."""
    refused: dict[str, str] = {}
    for name, levels in design.factors.items():
        for level, options in levels.items():
            try:
                load_system(SystemSpec(name=SYSTEM, options=options))
            except UserError as error:
                refused[f"{name} {level}"] = str(error)
    kept = {
        name: tuple(level for level in levels if f"{name} {level}" not in refused)
        for name, levels in design.factors.items()
    }
    return design.restricted(kept), refused


class Flight:
    """The cells of one setting, and how far they are."""

    def __init__(self, design: Design, levels: Levels, options: dict[str, str]) -> None:
        self.design, self.options = design, options
        self.name = ", ".join(f"{name} {level}" for name, level in levels.items())
        self.spec = SystemSpec(name=SYSTEM, options=options)
        self.system = load_system(self.spec)
        self.cells: list[Cell] = []
        self.rows: list[tuple[Row, ...]] = []
        """Arms of each cell."""
        library = library_of(self.system, design.library)
        for question, every, fault in design.asked(levels):
            request = AuditQuestion(
                baseline=question.baseline,
                repair=question.repair,
                fault=fault,
                library=design.library,
                scenes=design.most,
                seeds=(design.seed,),
                stop_when="decided",
            )
            audit = audit_analysis(self.system, self.spec, request, library)
            self.scenes = audit.plan.scenes
            for reach, condition in (("isolated", question.isolated), ("shared", "shared")):
                rows = [row for row in audit.plan.rows if row.condition == condition]
                named = [
                    row.model_copy(update={"condition": f"{fault} {condition}"}) for row in rows
                ]
                variants = {"baseline": question.baseline, "repair": question.repair}
                if rows:
                    self.rows.append(tuple(named))
                    self.cells.append(Cell(levels=every, reach=reach, ended=("", ""), **variants))
                elif reach == "isolated":
                    raise UserError(f"{fault} does not reach {condition}: name another module.")

    def trials(self, scenes: Callable[[Cell], int]) -> int:
        """Return the trials behind the cells, if each takes so many scenes; a treatment
        runs once."""
        longest: dict[str, int] = {}
        for cell, rows in zip(self.cells, self.rows, strict=True):
            for treatment in (row.treatment.key() for row in rows):
                longest[treatment] = max(longest.get(treatment, 0), scenes(cell))
        return sum(longest.values())

    def fly(
        self, folder: Path, executor: Executor, **how: Callable
    ) -> tuple[Iterable[Round], RunResult]:
        """Fly look by look what is not settled; return what was computed, and the last result."""
        design, waiting, rounds = self.design, list(range(len(self.cells))), list[Round]()
        place = folder / "flights" / self.name.replace(", ", "_").replace(" ", "-")
        for scenes in range(design.first, design.most + 1, design.look):
            rows = {(row.variant, row.condition): row for at in waiting for row in self.rows[at]}
            plan = Plan(
                name=self.name,
                system=self.spec,
                library=design.library,
                scenes=self.scenes[:scenes],
                rows=tuple(rows.values()),
                scenes_per_analysis=design.look,
            )
            began, first = time.monotonic(), scenes == design.first
            shared = {"shared": True, "executor": executor, "recheck": first}
            result = run_plan(plan, place, system=self.system, **shared, **how)
            if blocks := result.blocks_computed:
                rounds.append(
                    Round(
                        workers=executor.count,
                        blocks=blocks,
                        trials=blocks * design.look,
                        seconds=round(time.monotonic() - began, 2),
                    )
                )
            for at in waiting:
                self.cells[at] = _ended(self.cells[at], self.rows[at], result, plan.scenes)
            left = design.most - scenes
            waiting = [at for at in waiting if not settled(design, self.cells[at], left)]
            if not waiting:
                break
        return rounds, result


def _ended(cell: Cell, rows: Sequence[Row], result: RunResult, scenes: Sequence[str]) -> Cell:
    groups = (Group(name, rows[0].condition) for name in (cell.baseline, cell.repair))
    pairs = pair(result.trials, *groups).whole()
    names = [scene.id for scene in pairs.scenes]
    ends = [success[:, 0].astype(int) for success in pairs.ended(Status.SUCCESS)]
    known = [dict(zip(names, end, strict=True)) for end in ends]
    letters = tuple("".join(str(of.get(scene, VOID)) for scene in scenes) for of in known)
    return cell.model_copy(update={"ended": letters})


def fly(design: Design, folder: Path, workers: int | None, executor: str, show: Display) -> Flown:
    """Fly all settings, writing after each what is known; return everything."""
    started, path = datetime.now(UTC), folder / CELLS
    design, refused = offered(design)
    for level, why in refused.items():
        show.say(f"Left out: {level}. {why}")
    flights = [Flight(design, *setting) for setting in design.settings()]
    if not flights:
        raise UserError("the design has no cell that the installed system can fly.")
    most = [flight.trials(lambda cell: design.most) for flight in flights]
    cells = sum(len(flight.cells) for flight in flights)
    settings = counted(len(flights), "setting")
    show.say(f"{counted(cells, 'cell')} in {settings}, at most {sum(most)} trials.")
    make_folder(folder)
    before = Flown.model_validate_json(path.read_bytes()).rounds if path.is_file() else ()
    system, command = flights[-1].system, ("study.py", *sys.argv[1:])
    with (
        executor_of(system, workers, executor) as force,
        show.progress("Flying") as move,
    ):
        for at, flight in enumerate(flights):

            def note(progress: Progress, at: int = at) -> None:
                remark = f"setting {at + 1} of {len(flights)}"
                move(progress.within(sum(most), sum(most[:at]), remark))

            def notice(text: str) -> None:
                if not text.startswith("Kept "):  # as each look does
                    show.say(text)

            rounds, result = flight.fly(folder, force, progress=note, notice=notice)
            before = (*before, *rounds)
            for finding in result.findings:
                show.say(describe(finding))
            flown = Flown(
                design=design,
                left_out=refused,
                options=flight.options,
                cells=tuple(cell for flight in flights[: at + 1] for cell in flight.cells),
                trials=sum(flight.trials(lambda cell: len(cell.ended[0])) for flight in flights),
                rounds=before,
                complete=flight is flights[-1],
            )
            write_text(path, flown.model_dump_json(indent=1) + "\n", folder)
        result = replace(result, blocks_computed=sum(work.blocks for work in before))
        run_provenance(folder, [CELLS], result, started, command, force, system.backend)
    return flown


def main(arguments: Sequence[str] | None = None) -> int:
    """Do what was asked; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--out", type=Path, default=None, help="default runs/carry-over[-quick]")
    parser.add_argument("--design", type=Path, default=HERE / "design.yaml")
    parser.add_argument("--quick", action="store_true", help="a few cells of four scenes")
    parser.add_argument("--workers", type=int, default=None, help="default one per core")
    parser.add_argument("--executor", default="local", help="local, ray or ray:HOST:PORT")
    options = parser.parse_args(arguments)
    folder = (options.out or ROOT / "runs" / f"carry-over{'-quick' * options.quick}").resolve()
    show = Display(SafeConsole(stderr=True), ("study.py", *sys.argv[1:]))
    try:
        design = Design.read(options.design)
        if options.quick:
            design = design.restricted(design.quick.only, design.quick.scenes)
        with chdir(ROOT):  # the design names files of the checkout
            flown = fly(design, folder, options.workers, options.executor, show)
    except UserError as error:
        print(f"study.py: {error}", file=sys.stderr)
        return 130 if isinstance(error, Stopped) else 2
    print("\n\n".join(sentences(flown)))
    print(f"\nEverything that was flown is in {folder / CELLS}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
