"""Carrying a reproduction out: fly, measure, conclude, and write its files."""

import os
from pathlib import Path

from faultpath.api.job import Job
from faultpath_quadrotor.paper.reproduced import ReproductionRun
from faultpath.core.errors import Stopped
from faultpath.trials.evidence import EvidenceTable
from faultpath.decisions import Reproduction, RunProvenance
from faultpath_quadrotor.paper.report.page import reproduction_page
from faultpath_quadrotor.paper.report.terminal import ledger_markdown
from faultpath.trials.store import write_text
from faultpath.trials.store.folder import DELIVERIES
from faultpath_quadrotor.paper.central import of_page
from faultpath_quadrotor.paper.flights import fly
from faultpath_quadrotor.paper.run import RESULTS, Plan, conclude, measure_all, save
from faultpath.decisions.tables import latex, markdown
from faultpath.trials.work import Progress


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
