"""From cells to trials: one plan a setting, flown into one folder and laid out in one table."""

import hashlib
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from faultpath.api.job import Job
from faultpath.faults import at_readers
from faultpath.run.execution.runner import RunResult, run_plan
from faultpath.run.plan import Plan, Row, SystemSpec, Treatment
from faultpath.run.registry import load_system
from faultpath.run.trials import Trials
from faultpath.run.work.executor import Progress
from faultpath.system import System
from faultpath_paper.cells import SYSTEM, Cell, Profile, Setting

FLIGHTS = "flights"
"""Folder, inside that of a run, with one folder a setting."""


@dataclass(frozen=True)
class Leg:
    """All cells of one setting, ready to fly."""

    setting: Setting
    system: System
    plan: Plan

    @property
    def folder(self) -> str:
        """Name of the folder that keeps its trials."""
        return re.sub(r"[^A-Za-z0-9.=-]+", "_", str(self.setting))

    @property
    def trials(self) -> int:
        """Trials of all treatments."""
        return len(self.plan.treatments()) * len(self.plan.scenes)


@dataclass(frozen=True)
class Flown:
    """Results of the legs of a run."""

    legs: tuple[Leg, ...]
    results: tuple[RunResult, ...]

    @property
    def trials(self) -> Trials:
        """All trials, leg by leg."""
        return Trials.of(trial for result in self.results for trial in result.trials)

    @property
    def fingerprint(self) -> str:
        """Hash of the fingerprints of all legs."""
        fingerprints = "".join(result.system_fingerprint for result in self.results)
        return hashlib.sha256(fingerprints.encode()).hexdigest()[:16]


def legs_of(cells: Iterable[Cell], profile: Profile, options: Mapping[str, str]) -> tuple[Leg, ...]:
    """Return the legs of a profile, setting by setting in the order of `cells`.

    `options` are added to those of every setting. Raises `UserError` for an option that does not
    exist.
    """
    by_setting: dict[Setting, list[Cell]] = {}
    for cell in profile.cells(cells):
        by_setting.setdefault(cell.setting, []).append(cell)
    legs: list[Leg] = []
    for setting, members in by_setting.items():
        spec = SystemSpec(name=SYSTEM, options={**setting.options, **options})
        system = load_system(spec)
        scenes = system.library(setting.library).scenes[: profile.scenes]
        plan = Plan(
            name=str(setting),
            system=spec,
            library=setting.library,
            scenes=tuple(scene.id for scene in scenes),
            rows=tuple(_row(system, cell, seed) for cell in members for seed in cell.seeds),
        )
        legs.append(Leg(setting, system, plan))
    return tuple(legs)


def fly(legs: Sequence[Leg], job: Job, show: Callable[[Progress], None]) -> Flown:
    """Run the legs one after the other, keeping what the folder of a run already holds.

    Raises as `run_plan` does.
    """
    before, total = 0, sum(leg.trials for leg in legs)
    results: list[RunResult] = []
    for leg in legs:

        def progress(done: Progress, before: int = before, leg: Leg = leg) -> None:
            show(done.within(total, before, leg.plan.name))

        result = run_plan(
            leg.plan,
            job.folder / FLIGHTS / leg.folder,
            progress=progress,
            notice=job.display.say,
            system=leg.system,
            shared=True,
            executor=job.executor,
            time_limit_s=job.time_limit_s,
            recheck=False,
        )
        results.append(result)
        before += leg.trials
    return Flown(tuple(legs), tuple(results))


def _row(system: System, cell: Cell, seed: int) -> Row:
    readers = system.variants[cell.variant].readers
    faults = tuple(
        fault for text in cell.faults for fault in at_readers(system.fault(text), readers)
    )
    treatment = Treatment(variant=cell.variant, faults=faults, seed=seed)
    return Row(variant=cell.variant, condition=cell.condition, seed=seed, treatment=treatment)
