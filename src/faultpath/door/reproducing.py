"""Carrying a reproduction out: fly, measure, conclude, and write its files."""

import os
from collections.abc import Sequence
from pathlib import Path

from faultpath.door.display import Display, Now
from faultpath.door.reproduced import ReproductionRun
from faultpath.errors import Stopped
from faultpath.evidence import EvidenceTable
from faultpath.execution import Interrupted, RunResult, Stopwatch, run_provenance
from faultpath.record import Reproduction, RunProvenance
from faultpath.report.inputs import Traces
from faultpath.report.reproduction.inputs import ReproductionInput
from faultpath.report.reproduction.page import reproduction_page
from faultpath.report.reproduction.terminal import ledger_markdown
from faultpath.store import traces_of, write_text
from faultpath.store.folder import DELIVERIES
from faultpath.store.sealed import seal
from faultpath.studies import reversal
from faultpath.studies.central import of_page
from faultpath.studies.claims import LIMITS, TOPICS
from faultpath.studies.flights import Flown, Leg, Pace, fly
from faultpath.studies.pages import table_4
from faultpath.studies.run import RESULTS, Plan, conclude, measure_all, save
from faultpath.studies.shipped import beside
from faultpath.tables import latex, markdown
from faultpath.work import Executor


def carry_out(
    plan: Plan, folder: Path, hands: Executor, told: Display, time_limit_s: float | None = None
) -> ReproductionRun:
    """Fly, measure, conclude and write the files of a plan.

    Raises `Stopped` on Ctrl-C, and `UserError` where the plan cannot be run. `time_limit_s` is that
    of `run_study`.
    """
    stopwatch = Stopwatch()
    legs = plan.legs()
    if note := plan.substitution():
        told.say(note)
    try:
        flown = _fly(told, legs, folder, hands, time_limit_s)
        evidence = _measure(
            told, plan, folder, (os.cpu_count() or 1) if hands.name else hands.count
        )
    except (Interrupted, KeyboardInterrupt):
        raise Stopped(
            f"interrupted; what is finished is kept in {folder}, and the same {told.called} "
            "resumes."
        ) from None
    results = plan.results(flown.outcomes, evidence)
    place = folder / plan.place
    found = conclude(plan, flown, results)
    result = save(place, flown, results, evidence, found)
    _tell_failures(told, result)
    backend = plan.system.backend
    files = seal(place, (*RESULTS, DELIVERIES))
    provenance = run_provenance(result, stopwatch, told.command, hands, backend, files)
    write_text(place / "provenance.json", provenance.model_dump_json(indent=2) + "\n", place)
    _write_pages(place, plan, found, provenance, flown)
    return ReproductionRun(place, found, provenance)


def _fly(
    told: Display, legs: Sequence[Leg], folder: Path, hands: Executor, time_limit_s: float | None
) -> Flown:
    with told.progress("Flying") as show:

        def flying(now: Pace) -> None:
            count = f"{now.trials_done:.0f} of {now.trials_total:.0f} trials"
            show(Now(now.trials_done, now.trials_total, count, now.seconds_left, now.leg))

        return fly(legs, folder, hands, flying, told.say, time_limit_s)


def _measure(told: Display, plan: Plan, folder: Path, workers: int) -> EvidenceTable:
    if not plan.measurements():
        return EvidenceTable({})
    with told.progress("Measuring") as show:

        def measuring(done: float, total: float) -> None:
            show(Now(done, total, f"{done:.0f} of {total:.0f} flights"))

        return measure_all(plan, folder, workers, measuring)


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


def _tell_failures(told: Display, result: RunResult) -> None:
    if result.failures:
        told.say(f"{len(result.failures)} trials failed and void their pairs.", "bold red")
    for failure in result.failures:
        told.say(f"  {failure.scene}: {failure.error} ({failure.details})")
