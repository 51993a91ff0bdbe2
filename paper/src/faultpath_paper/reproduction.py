"""The paper's tables, figures and claims: run anew, or read from a folder."""

import os
from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import NoReturn

from faultpath.api.display import Display, display
from faultpath.api.folders import read_provenance
from faultpath.api.job import Job
from faultpath.api.runs import FinishedRun
from faultpath.api.systems import LOCAL, check_executor, executor_of
from faultpath.core.errors import Stopped, UserError
from faultpath.core.files.atomic import write_text
from faultpath.report.tables import markdown_block
from faultpath.run.provenance import AGAIN, RunProvenance, unseal
from faultpath.run.store.folder import DELIVERIES
from faultpath.run.work.executor import Progress
from faultpath_paper.answers import Reproduction
from faultpath_paper.central import of_page
from faultpath_paper.evidence.table import EvidenceTable
from faultpath_paper.flights import fly
from faultpath_paper.report.page import reproduction_page
from faultpath_paper.report.terminal import ledger_markdown
from faultpath_paper.report.words import headline
from faultpath_paper.run import (
    RESULTS,
    ChosenPages,
    chosen_pages,
    conclude,
    measure_all,
    read_results,
    save,
)


class ReproductionRun(FinishedRun):
    """A finished reproduction: its conclusions, and the folder of its files.

    A notebook shows the tables, with the paper's numbers beside our own.
    """

    record: Reproduction
    """Tables, figures, and in `ledger` the claims of the paper with their verdicts."""

    @property
    def headline(self) -> str:
        """How many claims are confirmed, in one sentence."""
        return f"{headline(self.record.ledger, self.record.profile)}."

    def report(self, folder: str | PathLike[str] | None = None) -> NoReturn:
        """Raise `UserError`: the pages of a reproduction are written when it is carried out."""
        raise UserError(f"the pages of the reproduction in {self.folder} stand there already.")

    def _repr_markdown_(self) -> str:
        return "\n\n".join(map(markdown_block, self.record.tables))


def read_reproduction(folder: Path) -> ReproductionRun:
    """Read a finished reproduction, every file compared with its digest in `provenance.json`.

    `UserError` for a file that is missing, damaged or changed, and for files that do not belong
    together.
    """
    provenance = read_provenance(folder)
    unseal(folder, provenance.files, RESULTS)
    results, record = read_results(folder)
    counts = len(results.trials), int(results.trials.failed.sum())
    if (record.trials, record.failed_trials) != counts:
        raise UserError(
            f"the files of {folder} do not belong together (reproduction.json counts other trials "
            f"than outcomes.parquet holds): {AGAIN}."
        )
    return ReproductionRun(folder, record, provenance)


def reproduce(
    pages: str | Sequence[str] = (),
    *,
    profile: str = "quick",
    folder: str | PathLike[str] | None = None,
    workers: int | None = None,
    device: str | None = None,
    time_limit_s: float | None = None,
    progress: bool | Display = True,
    executor: str = LOCAL,
) -> ReproductionRun:
    """Fly every study of the paper, or some of its pages, and compare the results with it.

    Args:
        pages: `table-4`, `figure-3`, `text` and so on; default all.
        profile: `quick` (few scenes, one seed) or `paper` (its size).
        folder: Run folder; default `runs/reproduction-<profile>-<code>`.
        workers: Worker processes, 0 for this process alone; default one per core, or per GPU.
        device: `cpu` (default) or `cuda`.
        time_limit_s: Seconds that a block of scenes may take in a worker.
        progress: As in `audit`.
        executor: As in `audit`, for the flights; windows are measured on this machine.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    arguments = dict(locals())
    check_executor(executor)
    named = (pages,) if isinstance(pages, str) else tuple(pages)
    chosen = chosen_pages(named, profile, {} if device is None else {"device": device})
    place = Path(folder) if folder else chosen.folder(f"reproduction-{chosen.profile.name}")
    terminal = display(progress, "reproduce", arguments | {"pages": named})

    with executor_of(chosen.system, workers, executor) as workforce:
        return carry_out(chosen, Job(place, workforce, terminal, time_limit_s))


def carry_out(chosen: ChosenPages, job: Job) -> ReproductionRun:
    """Run, measure, conclude and write the files of a reproduction.

    Raises `Stopped` on Ctrl-C, and `UserError` where it cannot be run.
    """
    display, folder, executor = job.display, job.folder, job.executor
    legs = chosen.legs()
    with display.progress("Running") as show:
        flown = fly(legs, job, show)
    evidence = EvidenceTable({})
    if chosen.measurements():
        workers = (os.cpu_count() or 1) if executor.name else executor.count
        try:
            with display.progress("Measuring") as show:

                def measuring(done: float, total: float) -> None:
                    show(Progress(done, total, f"{done:.0f} of {total:.0f} flights"))

                evidence = measure_all(chosen, folder, workers, measuring)
        except KeyboardInterrupt:
            raise Stopped(
                f"interrupted; what is finished is kept in {folder}, and the same "
                f"{display.called} resumes."
            ) from None
    results = chosen.results(flown.trials, evidence)
    place = folder / chosen.place
    record = conclude(chosen, results)
    result = save(place, flown, results, record)
    files = (*RESULTS, DELIVERIES)
    provenance = replace(job, folder=place).finish(result, files, chosen.system.backend)
    write_pages(place, record, provenance)
    return ReproductionRun(place, record, provenance)


def write_pages(place: Path, record: Reproduction, provenance: RunProvenance) -> None:
    """Write the page, the tables and the ledger of a reproduction into a folder."""
    page = reproduction_page(record, provenance, of_page(record, provenance.code.data))
    write_text(place / "reproduction.html", page, place)
    write_text(place / "tables.md", "\n\n".join(map(markdown_block, record.tables)) + "\n", place)
    write_text(place / "ledger.md", ledger_markdown(record.ledger, record.profile), place)
