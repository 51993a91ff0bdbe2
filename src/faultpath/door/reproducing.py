"""Carrying a reproduction out: fly, measure, conclude, and write its files."""

import os
from pathlib import Path

from faultpath.door.job import Job
from faultpath.door.reproduced import ReproductionRun
from faultpath.errors import Stopped
from faultpath.evidence import EvidenceTable
from faultpath.record import Reproduction, RunProvenance
from faultpath.report.inputs import Traces
from faultpath.report.reproduction.inputs import ReproductionInput
from faultpath.report.reproduction.page import reproduction_page
from faultpath.report.reproduction.terminal import ledger_markdown
from faultpath.store import traces_of, write_text
from faultpath.store.folder import DELIVERIES
from faultpath.studies import reversal
from faultpath.studies.central import of_page
from faultpath.studies.claims import LIMITS, TOPICS
from faultpath.studies.flights import Flown, fly
from faultpath.studies.pages import table_4
from faultpath.studies.run import RESULTS, Plan, conclude, measure_all, save
from faultpath.studies.shipped import beside
from faultpath.tables import latex, markdown
from faultpath.work import Progress


def carry_out(plan: Plan, job: Job) -> ReproductionRun:
    """Run, measure, conclude and write the files of a plan.

    Raises `Stopped` on Ctrl-C, and `UserError` where the plan cannot be run.
    """
    display, folder, executor = job.display, job.folder, job.executor
    legs = plan.legs()
    if note := plan.substitution():
        display.say(note)
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
    found = conclude(plan, flown, results)
    result = save(place, flown, results, evidence, found)
    provenance = job.finish(result, plan.system, (*RESULTS, DELIVERIES), place)
    _write_pages(place, plan, found, provenance, flown)
    return ReproductionRun(place, found, provenance)


def _write_pages(
    place: Path, plan: Plan, found: Reproduction, provenance: RunProvenance, flown: Flown
) -> None:
    windy = next((i for i, leg in enumerate(flown.legs) if leg.setting == table_4.WINDY), None)
    asked = reversal.audited(flown.outcomes)
    system = plan.system
    decision, variants = None, ()
    if windy is not None and reversal.whole(asked):
        leg = flown.legs[windy]
        decision = reversal.decision(asked, leg, flown.results[windy].deliveries)
        variants = reversal.wired(leg)
    source = ReproductionInput(
        reproduction=found,
        provenance=provenance,
        interface=system.interface,
        variants=variants,
        outcomes=asked,
        decision=decision,
        traces=Traces(traces_of(asked), system.control_dt_s),
        plans={
            scene: drawn
            for scene in {*(row.outcome.scene for row in asked.rows), *_gallery(found)}
            if (drawn := system.floor_plan(scene)) is not None
        },
        beside=beside(found.ledger),
        topics=TOPICS,
        limits=LIMITS,
        central=of_page(found),
    )
    write_text(place / "reproduction.html", reproduction_page(source), place)
    write_text(place / "tables.tex", latex.document(found.tables), place)
    write_text(place / "tables.md", "\n\n".join(map(markdown.block, found.tables)) + "\n", place)
    write_text(place / "ledger.md", ledger_markdown(found.ledger, found.profile), place)


def _gallery(found: Reproduction) -> list[str]:
    return [shown.scene for shown in found.gallery]
