"""A reproduction from start to end: fly, measure, conclude, and keep what was found."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from faultpath.errors import UserError
from faultpath.evidence import EvidenceTable, Measurement
from faultpath.execution import RunResult
from faultpath.files.opening import LARGEST_TEXT, contents
from faultpath.files.plain import Misread, model_of
from faultpath.record import Configuration, Reproduction, RunProvenance, SceneShown, Sweep
from faultpath.store import (
    RunFolder,
    read_evidence,
    read_outcomes,
    write_evidence,
    write_text,
)
from faultpath.store.folder import OUTCOMES
from faultpath.store.manifest import keyed
from faultpath.store.sealed import read_regular, unseal
from faultpath.studies import reversal, stand_in
from faultpath.studies.cells import HELD_OUT, PROFILES, SYSTEM, Profile
from faultpath.studies.claims import ledger
from faultpath.studies.flights import Flown, Leg, plan_legs
from faultpath.studies.page import Page
from faultpath.studies.pages import PAGES
from faultpath.studies.results import Results
from faultpath.studies.shipped import PLATFORM, default_platform
from faultpath.tables import Table
from faultpath.trials import (
    Deliveries,
    Library,
    OutcomeTable,
    System,
    SystemSpec,
    load_measurer,
    load_system,
)
from faultpath.trials.state import system_code

EVIDENCE = "evidence.parquet"
CONCLUSIONS = "reproduction.json"
RESULTS = (CONCLUSIONS, OUTCOMES, EVIDENCE)
"""The files that `read_results` reads."""


@dataclass(frozen=True)
class Plan:
    """What is to be reproduced, of how much, and with what."""

    pages: tuple[Page, ...]
    profile: Profile
    libraries: Mapping[str, str] = field(default_factory=dict[str, str])
    """Library that stands for a role, such as `held-out`, where it is not the one of that name."""
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

    @property
    def platform(self) -> str:
        """The platform that it flies on."""
        return self.options.get(PLATFORM, default_platform())

    def legs(self) -> tuple[Leg, ...]:
        """Return what there is to fly."""
        cells = [cell for page in self.pages for cell in page.cells]
        return plan_legs(cells, self.profile, self.libraries, self.options)

    def measurements(self) -> dict[Measurement, Measurement]:
        """Return what there is to measure, each with the one that this run makes for it."""
        asked = (m for page in self.pages for m in page.measurements)
        return {m: self._stands_in(m) for m in asked if m.seed in self.profile.seeds}

    @cached_property
    def system(self) -> System:
        """The system in its first setting, for what does not depend on the setting."""
        return load_system(SystemSpec(name=SYSTEM, options=dict(self.options)))

    def folder(self, name: str) -> Path:
        """Return the run folder of that name for the code as it is."""
        spec = SystemSpec(name=SYSTEM, options=dict(self.options))
        return keyed(Path("runs"), name, system_code(self.system, spec).state)

    def library(self) -> Library:
        """Return the library that stands for the held-out one."""
        return self.system.library(self.libraries.get(HELD_OUT, HELD_OUT))

    def substitution(self) -> str:
        """Return what takes the place of the held-out library, and which pages that leaves alone.

        Raises `UserError` where no page of the plan flies on the held-out library.
        """
        if HELD_OUT not in self.libraries:
            return ""
        return stand_in.words(self.pages, self.profile, self.libraries[HELD_OUT], self.library())

    def results(self, outcomes: OutcomeTable, evidence: EvidenceTable) -> Results:
        """Return what was flown and measured, as pages and claims ask for it."""
        library = self.library()
        names = {HELD_OUT: stand_in.shown(library.name)}
        return Results(outcomes, evidence, library.content_hash, names)

    def _stands_in(self, measurement: Measurement) -> Measurement:
        recording = measurement.recording
        changed = {
            "library": self.libraries.get(recording.library, recording.library),
            "options": {**recording.options, **self.options},
        }
        return measurement.model_copy(update={"recording": recording.model_copy(update=changed)})


def plan(
    names: Sequence[str],
    profile: str,
    libraries: Mapping[str, str] | None = None,
    options: Mapping[str, str] | None = None,
) -> Plan:
    """Return the plan for some pages, or for all; `UserError` for a name that does not exist."""
    known = {page.name: page for page in PAGES}
    for name in names:
        if name not in known:
            raise UserError(f"the paper has no page '{name}'; choose from {', '.join(known)}.")
    if profile not in PROFILES:
        raise UserError(f"unknown profile '{profile}'; choose one of {', '.join(PROFILES)}.")
    pages = tuple(page for page in PAGES if page.name in names) if names else PAGES
    return Plan(pages, PROFILES[profile], libraries or {}, options or {})


def standing(library: str | None) -> dict[str, str]:
    """Return the libraries of a plan in which one by name or file stands for the held-out one."""
    return {} if library in (None, HELD_OUT) else {HELD_OUT: library}


def measure_all(
    plan: Plan, folder: Path, workers: int, progress: Callable[[float, float], None]
) -> EvidenceTable:
    """Measure on recorded windows what `folder` does not hold yet.

    Raises as `evidence.Measurer` does.
    """
    wanted = plan.measurements()
    measure = load_measurer(SYSTEM)
    made = tuple(dict.fromkeys(wanted.values()))
    found = measure(made, plan.profile.scenes, folder / "windows", workers, progress)
    return EvidenceTable({asked: found.values(stand_in) for asked, stand_in in wanted.items()})


def conclude(plan: Plan, flown: Flown, results: Results) -> Reproduction:
    """Evaluate pages and claims."""
    library = plan.library()
    scenes = library.scenes[: plan.profile.scenes]
    built = [part for page in plan.pages for part in page.build(results)]
    rows = results.outcomes.rows
    return Reproduction(
        profile=plan.profile.name,
        ledger=ledger(
            results,
            library.name,
            library.content_hash,
            len(scenes),
            plan.profile.seeds,
            only_run=not plan.whole,
            note=plan.substitution(),
            platform=plan.platform,
        ),
        tables=tuple(part for part in built if isinstance(part, Table)),
        figures=tuple(part for part in built if isinstance(part, Sweep)),
        gallery=_gallery(library),
        configurations=tuple(map(_configuration, flown.legs, flown.results)),
        trials=len(rows),
        failed_trials=sum(row.outcome.failed for row in rows),
        flown=flown.written,
    )


def save(
    folder: Path, flown: Flown, results: Results, evidence: EvidenceTable, found: Reproduction
) -> RunResult:
    """Write outcomes, evidence and conclusions; return the run as one result.

    Of the traces only those stay that a report shows: flights of Table IV's question.
    """
    folder.mkdir(parents=True, exist_ok=True)
    slim = tuple(
        row if reversal.concerns(row) else replace(row, outcome=replace(row.outcome, trace=None))
        for row in results.outcomes.rows
    )
    deliveries = Deliveries(
        rows=tuple(row for result in flown.results for row in result.deliveries.rows),
        findings=tuple(dict.fromkeys(said for result in flown.results for said in result.findings)),
    )
    digest = RunFolder(folder).save_tables(OutcomeTable(slim), deliveries)
    write_evidence(folder / EVIDENCE, evidence)
    write_text(folder / CONCLUSIONS, found.model_dump_json(indent=1) + "\n", folder)
    return RunResult(
        outcomes=results.outcomes,
        deliveries=deliveries,
        traces={},
        blocks_computed=sum(result.blocks_computed for result in flown.results),
        blocks_kept=sum(result.blocks_kept for result in flown.results),
        failures=tuple(failure for result in flown.results for failure in result.failures),
        outcomes_sha256=digest,
        system_fingerprint=flown.fingerprint,
        code=tuple(code for result in flown.results for code in result.code),
        library_hash=results.library_hash,
        flown_again=tuple(again for result in flown.results for again in result.flown_again),
    )


def read_results(folder: Path) -> tuple[Results, Reproduction]:
    """Read what `save` wrote; `UserError` for a folder without a finished reproduction.

    Where the run left its provenance, the files are compared with the digests in it first.
    """
    _check_digests(folder)
    try:
        found = model_of(contents(folder / CONCLUSIONS, LARGEST_TEXT), Reproduction)
    except (OSError, Misread):
        raise UserError(
            f"{folder} holds no finished reproduction: give the folder of one, or make it with "
            "`faultpath reproduce`."
        ) from None
    outcomes = read_outcomes(folder / OUTCOMES)
    evidence = read_evidence(folder / EVIDENCE)
    names = {HELD_OUT: stand_in.shown(found.ledger.library)}
    return Results(outcomes, evidence, found.ledger.library_hash, names), found


def _check_digests(folder: Path) -> None:
    place = folder / "provenance.json"
    if not place.exists():
        return
    try:
        provenance = model_of(read_regular(place), RunProvenance)
    except Misread:
        raise UserError(
            f"{place} is damaged or from another version of faultpath: reproduce the paper again."
        ) from None
    named = {name: digest for name, digest in provenance.files.items() if name in RESULTS}
    unseal(folder, {OUTCOMES: provenance.outcomes_sha256, **named}, ())


def _gallery(library: Library) -> tuple[SceneShown, ...]:
    first = {scene.topology: scene for scene in reversed(library.scenes)}
    scenes = sorted(first.values(), key=lambda scene: scene.index)
    return tuple(SceneShown(scene=scene.id, topology=scene.topology) for scene in scenes)


def _configuration(leg: Leg, result: RunResult) -> Configuration:
    return Configuration(
        setting=leg.title,
        library=leg.study.library,
        library_hash=result.library_hash,
        system_fingerprint=result.system_fingerprint,
        arms=len(leg.study.arms()),
        trials=leg.trials,
    )
