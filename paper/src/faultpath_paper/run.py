"""A reproduction from start to end: run, measure, conclude, and save the conclusions."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from faultpath.core.errors import UserError
from faultpath.core.files.atomic import write_text
from faultpath.core.files.opening import LARGEST_TEXT, contents, read_regular
from faultpath.core.files.plain import Misread, model_of
from faultpath.report.tables import Table
from faultpath.run.code import system_code
from faultpath.run.deliveries import Deliveries
from faultpath.run.execution.runner import RunResult
from faultpath.run.plan import SystemSpec
from faultpath.run.provenance import RunProvenance, unseal
from faultpath.run.registry import load_system
from faultpath.run.store.folder import (
    OUTCOMES,
    RunFolder,
    keyed,
    read_outcomes,
)
from faultpath.run.trials import Trials
from faultpath.system import System
from faultpath_paper.answers import Reproduction, Sweep
from faultpath_paper.cells import HELD_OUT, PROFILES, SYSTEM, Profile
from faultpath_paper.claims import ledger
from faultpath_paper.evidence.table import EvidenceTable, Measurement, read_evidence, write_evidence
from faultpath_paper.flights import Flown, Leg, legs_of
from faultpath_paper.page import Page
from faultpath_paper.pages import PAGES
from faultpath_paper.results import Results

EVIDENCE = "evidence.parquet"
CONCLUSIONS = "reproduction.json"
RESULTS = (CONCLUSIONS, OUTCOMES, EVIDENCE)
"""The files that `read_results` reads."""


@dataclass(frozen=True)
class ChosenPages:
    """Pages to reproduce, with their profile and options of the system."""

    pages: tuple[Page, ...]
    profile: Profile
    options: Mapping[str, str] = field(default_factory=dict[str, str])
    """Options of the system beside those of the settings, such as the device."""

    @property
    def whole(self) -> bool:
        """Whether this is every page of the paper."""
        return self.pages == PAGES

    @property
    def place(self) -> str:
        """Folder, inside that of the run, for what these pages conclude."""
        return "." if self.whole else "+".join(page.name for page in self.pages)

    def legs(self) -> tuple[Leg, ...]:
        """Return the legs to run."""
        cells = [cell for page in self.pages for cell in page.cells]
        return legs_of(cells, self.profile, self.options)

    def measurements(self) -> dict[Measurement, Measurement]:
        """Return the measurements of the pages, each with the one that this run makes for it."""
        measurements = (m for page in self.pages for m in page.measurements)
        own: dict[Measurement, Measurement] = {}
        for measurement in measurements:
            if measurement.seed in self.profile.seeds:
                options = {**measurement.recording.options, **self.options}
                recording = measurement.recording.model_copy(update={"options": options})
                own[measurement] = measurement.model_copy(update={"recording": recording})
        return own

    @cached_property
    def system(self) -> System:
        """The system in its first setting, for what does not depend on the setting."""
        return load_system(SystemSpec(name=SYSTEM, options=dict(self.options)))

    def folder(self, name: str) -> Path:
        """Return the run folder of that name for the code as it is."""
        spec = SystemSpec(name=SYSTEM, options=dict(self.options))
        return keyed(name, system_code(self.system, spec).state)

    def results(self, trials: Trials, evidence: EvidenceTable) -> Results:
        """Return what was run and measured, as pages and claims ask for it."""
        return Results(trials, evidence, self.system.library(HELD_OUT).content_hash)


def chosen_pages(
    names: Sequence[str], profile: str, options: Mapping[str, str] | None = None
) -> ChosenPages:
    """Return some pages, or all; `UserError` for a name that does not exist."""
    known = {page.name: page for page in PAGES}
    for name in names:
        if name not in known:
            raise UserError(f"the paper has no page '{name}'; choose from {', '.join(known)}.")
    if profile not in PROFILES:
        raise UserError(f"unknown profile '{profile}'; choose one of {', '.join(PROFILES)}.")
    pages = tuple(page for page in PAGES if page.name in names) if names else PAGES
    return ChosenPages(pages, PROFILES[profile], options or {})


def measure_all(
    chosen: ChosenPages, folder: Path, workers: int, progress: Callable[[float, float], None]
) -> EvidenceTable:
    """Measure on recorded windows what `folder` does not hold yet.

    Raises as `measure` does.
    """
    from faultpath_paper.evidence.quantities import measure  # it loads torch

    measurements = chosen.measurements()
    unique = tuple(dict.fromkeys(measurements.values()))
    table = measure(unique, chosen.profile.scenes, folder / "windows", workers, progress)
    return EvidenceTable({m: table[own] for m, own in measurements.items()})


def conclude(chosen: ChosenPages, results: Results) -> Reproduction:
    """Evaluate pages and claims."""
    library = chosen.system.library(HELD_OUT)
    return Reproduction(
        profile=chosen.profile.name,
        ledger=ledger(
            results,
            library.name,
            library.content_hash,
            len(library.scenes[: chosen.profile.scenes]),
            chosen.profile.seeds,
            only_run=not chosen.whole,
        ),
        **built(results, chosen.pages),
        trials=len(results.trials),
        failed_trials=int(results.trials.failed.sum()),
    )


def built(results: Results, pages: Iterable[Page] = PAGES) -> dict[str, Any]:
    """Return the tables and figures of pages as a run fills them."""
    parts = [part for page in pages for part in page.build(results)]
    return {
        "tables": tuple(part for part in parts if isinstance(part, Table)),
        "figures": tuple(part for part in parts if isinstance(part, Sweep)),
    }


def save(folder: Path, flown: Flown, results: Results, record: Reproduction) -> RunResult:
    """Write outcomes, evidence and conclusions; return the run as one result, without traces."""
    folder.mkdir(parents=True, exist_ok=True)
    findings = (finding for result in flown.results for finding in result.findings)
    deliveries = Deliveries(
        rows=tuple(row for result in flown.results for row in result.deliveries.rows),
        findings=tuple(dict.fromkeys(findings)),
    )
    digest = RunFolder(folder).save_tables(replace(results.trials, traces={}), deliveries)
    write_evidence(folder / EVIDENCE, results.evidence)
    write_text(folder / CONCLUSIONS, record.model_dump_json(indent=1) + "\n", folder)
    return RunResult(
        trials=results.trials,
        deliveries=deliveries,
        blocks_computed=sum(result.blocks_computed for result in flown.results),
        blocks_kept=sum(result.blocks_kept for result in flown.results),
        failures=tuple(failure for result in flown.results for failure in result.failures),
        outcomes_sha256=digest,
        system_fingerprint=flown.fingerprint,
        code=tuple(code for result in flown.results for code in result.code),
        library_hash=results.library_hash,
        rechecks=tuple(again for result in flown.results for again in result.rechecks),
    )


def read_results(folder: Path) -> tuple[Results, Reproduction]:
    """Read what `save` wrote; `UserError` for a folder without a finished reproduction.

    Where the run left its provenance, the files are compared with the digests in it first.
    """
    place = folder / "provenance.json"
    if place.exists():
        try:
            provenance = model_of(read_regular(place), RunProvenance)
        except Misread:
            raise UserError(
                f"{place} is damaged or from another version of faultpath: reproduce the paper "
                "again."
            ) from None
        named = {name: digest for name, digest in provenance.files.items() if name in RESULTS}
        unseal(folder, named, ())
    try:
        record = model_of(contents(folder / CONCLUSIONS, LARGEST_TEXT), Reproduction)
    except (OSError, Misread):
        raise UserError(
            f"{folder} holds no finished reproduction: give the folder of one, or make it with "
            "`faultpath reproduce`."
        ) from None
    trials = read_outcomes(folder / OUTCOMES)
    evidence = read_evidence(folder / EVIDENCE)
    return Results(trials, evidence, record.ledger.library_hash), record
