"""Carrying a reproduction out: fly, measure, conclude, and write its files."""

import os
from pathlib import Path

from faultpath.door.job import Job
from faultpath.door.reproduced import ReproductionRun
from faultpath.errors import Stopped
from faultpath.evidence import EvidenceTable
from faultpath.record import Reproduction, RunProvenance
from faultpath.report.reproduction.page import reproduction_page
from faultpath.report.reproduction.terminal import ledger_markdown
from faultpath.store import write_text
from faultpath.store.folder import DELIVERIES
from faultpath.studies.central import of_page
from faultpath.studies.flights import fly
from faultpath.studies.run import RESULTS, Plan, conclude, measure_all, save
from faultpath.tables import latex, markdown
from faultpath.work import Progress


def carry_out(plan: Plan, job: Job) -> ReproductionRun:
    """Run, measure, conclude and write the files of a plan.

    Raises `Stopped` on Ctrl-C, and `UserError` where the plan cannot be run.
    """
    display, folder, executor = job.display, job.folder, job.executor
    legs = plan.legs()
    with display.progress("Running") as show:
        flown = fly(legs, folder, job.run, show)
    evidence = EvidenceTable({})
    if plan.measurements():
        workers = (os.cpu_count() or 1) if executor.name else executor.count
        try:
            with display.progress("Measuring") as show:

                def measuring(done: float, total: float) -> None:
                    show(Progress(done, total, f"{done:.0f} of {total:.0f} flights"))

                evidence = measure_all(plan, folder, workers, measuring)
        except KeyboardInterrupt:
            raise Stopped(
                f"interrupted; what is finished is kept in {folder}, and the same "
                f"{display.called} resumes."
            ) from None
    results = plan.results(flown.outcomes, evidence)
    place = folder / plan.place
    found = conclude(plan, results)
    result = save(place, flown, results, evidence, found)
    provenance = job.finish(result, plan.system, (*RESULTS, DELIVERIES), place)
    write_pages(place, found, provenance)
    return ReproductionRun(place, found, provenance)


def write_pages(place: Path, found: Reproduction, provenance: RunProvenance) -> None:
    """Write the page, the tables and the ledger of a reproduction into a folder."""
    page = reproduction_page(found, provenance, of_page(found))
    write_text(place / "reproduction.html", page, place)
    write_text(place / "tables.tex", latex.document(found.tables), place)
    write_text(place / "tables.md", "\n\n".join(map(markdown.block, found.tables)) + "\n", place)
    write_text(place / "ledger.md", ledger_markdown(found.ledger, found.profile), place)
