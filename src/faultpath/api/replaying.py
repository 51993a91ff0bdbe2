"""Running trials of a finished run again: do they come out as they did, and what was read."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from platform import python_version

from faultpath.analyses.audit import audit_analysis
from faultpath.analyses.model import AuditResult
from faultpath.analyses.pairs import by_scene, read_pairs
from faultpath.analyses.pairs import choose as picked
from faultpath.analyses.parting import Parting, Recorded, parting
from faultpath.api.folders import RECORD
from faultpath.api.systems import check_named, choose
from faultpath.core.errors import UserError
from faultpath.core.files.atomic import write_file
from faultpath.core.text import unknown
from faultpath.core.trees import release
from faultpath.report.html import write_report
from faultpath.report.inputs import ReportInput
from faultpath.run.attempt import Done
from faultpath.run.check.blocks import BlockSpec, RecordedBlock, run_blocks
from faultpath.run.code import CodeState, named, system_code
from faultpath.run.execution.dispatch import Built
from faultpath.run.execution.recheck import deviation
from faultpath.run.findings import Deviation
from faultpath.run.plan import Plan, SystemSpec, Treatment
from faultpath.run.provenance import RunProvenance, amend, processor
from faultpath.run.question import AuditQuestion
from faultpath.run.store.signals import SIGNALS, Signal, encode_signals
from faultpath.run.store.tables import TrialAddress
from faultpath.run.trials import Trials
from faultpath.run.work.executor import Executor
from faultpath.run.work.processes import local
from faultpath.system.checks import library_of
from faultpath.system.outcome import Outcome
from faultpath.system.system import System

_PROCESSOR = "the processor"


@dataclass(frozen=True)
class Replay:
    """Trials of a run, run again."""

    trials: Sequence["Replayed"]
    changed: Sequence[str]
    """Changes since the run, in words; the processor last."""

    @property
    def elsewhere(self) -> str:
        """The other processor, in words; empty on that of the run."""
        return next((change for change in self.changed if change.startswith(_PROCESSOR)), "")


@dataclass(frozen=True)
class Replayed:
    """One trial, run again."""

    address: TrialAddress
    deviation: Deviation | None
    """How the second trial differs; `None` where it is the same to the bit."""
    signals: tuple[Signal, ...] = field(default=(), repr=False)


def chosen_scenes(
    source: ReportInput, scenes: Sequence[str], conditions: Sequence[str]
) -> tuple[str, ...]:
    """Return the scenes to run again, by default those that the report begins with.

    `UserError` for a scene or condition that the run does not have.
    """
    every = [scene.id for scene in source.trials.scenes]
    named = [condition.name for condition in source.record.conditions]
    for what, names, known in (("scene", scenes, every), ("condition", conditions, named)):
        for name in names:
            if name not in known:
                raise UserError(f"the run: {unknown(what, name, known)}")
    if scenes:
        return tuple(dict.fromkeys(scenes))
    return tuple(scene for scene, _ in shown_first(source.record, source.trials, source.signals))


def shown_first(
    record: AuditResult, trials: Trials, recorded: Iterable[TrialAddress] = ()
) -> tuple[tuple[str, int], ...]:
    """Return the scenes that the report begins with, and the seed of each; of scenes that go alike
    those of `recorded` trials come first."""
    pairs = read_pairs(trials, record)
    kept = {(at.scene, at.seed) for at in recorded}
    return picked(record, pairs, kept) or tuple(by_scene(pairs))[:1]


def replay(
    source: ReportInput,
    scenes: Sequence[str],
    conditions: Sequence[str] = (),
    say: Callable[[str], None] = lambda text: None,
    trust: bool = False,
    code: Sequence[str] = (),
) -> Replay:
    """Run the trials of some scenes again, under all conditions or some, with both versions.

    The folder may be anybody's: without `trust`, what it names beside installed systems has to
    stand in `code` too.
    Raises `UserError` where the system cannot be built, or no longer has the scenes and variants
    of the run.
    """
    question, facts = source.record.question, source.record.facts
    if not isinstance(question, AuditQuestion):
        raise UserError(
            "other tools ran these trials, and nothing of theirs can be run again here."
        )
    if SystemSpec(name=facts.system).is_object:
        raise UserError(
            f"the run is of a {facts.system}, which only its own process had: put what builds "
            "the system into a file, and audit that."
        )
    treatments = question.baseline, question.repair
    spec = SystemSpec(name=facts.system, options=question.options)
    check_named(RECORD, spec, treatments, code, trust)
    chosen = choose(spec.name, spec.options, None, treatments)
    system = chosen.system
    library = library_of(system, facts.library)
    if library.content_hash != facts.library_hash:
        raise UserError(
            f"library '{facts.library}' has other scenes than the run: bring its file back."
        )
    plan = audit_analysis(system, chosen.spec, question, library).plan
    before = outcomes_at(source.trials)
    named = conditions or {row.condition for row in plan.rows}
    addresses = [at for at in before if at.scene in scenes and at.condition in named]

    def note(treatment: Treatment, done: int, total: int) -> None:
        what = f"{treatment.variant}, seed {treatment.seed}, again: {treatment.describe()}"
        say(f"Ran {what} ({done} of {total}).")

    with local(0) as executor:
        trials = run_again(before, plan, system, executor, addresses, note)
    return Replay(
        trials, changes(source.provenance, system, system_code(system, chosen.spec).state)
    )


def changes(run: RunProvenance, system: System, state: CodeState) -> tuple[str, ...]:
    """Say what has changed since a run, of all that may decide a trial."""
    files = {**run.code.sources, **run.code.data}, {**state.files, **state.data}
    names = sorted(
        name
        for name in {*files[0], *files[1]}
        if files[0].get(name) != files[1].get(name)
        and (name in files[1] or name.partition("/")[0] not in files[1])  # a package is one entry
    )
    versions = {"Python": (run.machine.python, python_version())}
    versions |= {
        name: (text, here) for name, text in run.machine.packages.items() if (here := release(name))
    }
    changed = [f"files ({named(names)})"] * bool(names)
    changed += [f"{name} ({a}, here {b})" for name, (a, b) in versions.items() if a != b]
    for what, before, here in (
        ("what computes", run.machine.backend, system.backend),
        (_PROCESSOR, run.machine.processor, processor()),
    ):
        changed += [f"{what} ({before or 'not said'}, here {here})"] * (before != here)
    return tuple(changed)


def outcomes_at(trials: Trials) -> dict[TrialAddress, Outcome]:
    """Return the trials of a run that ran to their end."""
    return {
        TrialAddress(trial.variant, trial.condition, trial.seed, trial.outcome.scene): trial.outcome
        for trial in trials
        if not trial.outcome.failed
    }


def run_again(
    before: Mapping[TrialAddress, Outcome],
    plan: Plan,
    system: System,
    executor: Executor,
    trials: Iterable[TrialAddress],
    note: Callable[[Treatment, int, int], None],
) -> list[Replayed]:
    """Run some trials of a plan again and listen; a treatment that several conditions share runs
    once.

    Raises what makes an audit itself wrong: code that changed under way, workers that do not start.
    """
    chosen = before.keys() & set(trials)
    treatments: dict[str, Treatment] = {}
    addresses: dict[str, dict[str, list[TrialAddress]]] = {}
    for row in plan.rows:
        for scene in plan.scenes:
            at = TrialAddress(row.variant, row.condition, row.seed, scene)
            if at in chosen:
                treatments[key := row.treatment.key()] = row.treatment
                addresses.setdefault(key, {}).setdefault(scene, []).append(at)
    tasks = [
        BlockSpec(treatments[key], tuple(scenes), signals=True) for key, scenes in addresses.items()
    ]
    replays: dict[TrialAddress, Replayed] = {}
    done = 0

    def handle_reply(task: BlockSpec, run: RecordedBlock) -> None:
        nonlocal done
        done += 1
        for place, scene in enumerate(task.scenes):
            for at in addresses[task.treatment.key()][scene]:
                differs, signals = Deviation(raised=run.error, scenes=(scene,), of=1), ()
                if not run.error:
                    again = Done((run.outcomes[place],), ())
                    differs = deviation([before[at]], again)
                    signals = () if differs else run.signals[place]
                replays[at] = Replayed(at, differs, signals)
        note(task.treatment, done, len(tasks))

    built = Built.of(system, plan.system, plan.library)
    run_blocks(executor, built, tasks, handle_reply)
    return [replays[at] for at in before if at in replays]


def where_parted(
    source: ReportInput,
    replays: Sequence[Replayed],
    scenes: Sequence[str],
    conditions: Sequence[str] = (),
) -> list[Parting]:
    """Return where trials that were run again part: the two versions under each condition, and,
    where several `conditions` are named, each version under the first and under each other.

    Left out is what came out otherwise than in the run.
    """
    question, trials = source.record.question, source.trials
    versions = question.baseline, question.repair
    known = [condition.name for condition in source.record.conditions]
    named = list(dict.fromkeys(conditions)) or known
    couples = [tuple((version, name) for version in versions) for name in named]
    couples += [
        ((version, conditions[0]), (version, name))
        for version in versions
        for name in named[1:] * bool(conditions)
    ]
    again = {replay.address: replay for replay in replays}
    ids = [scene.id for scene in trials.scenes]

    def heard(variant: str, condition: str, place: int, scene: str) -> Recorded:
        at = TrialAddress(variant, condition, trials.seeds[place], scene)
        row = int(trials.planned(variant, condition)[place, ids.index(scene)])
        outcome = trials.outcome(row, scene) if row >= 0 else None
        return Recorded(at, outcome, again[at].signals if at in again else ())

    partings: list[Parting] = []
    for scene in scenes:
        for place in range(len(trials.seeds)):
            for couple in couples:
                one, other = (heard(*of, place, scene) for of in couple)
                unlike = (again[of.address].deviation for of in (one, other) if of.address in again)
                if not any(unlike):
                    partings.append(parting(source.system, one, other))
    return partings


def keep_signals(folder: Path, source: ReportInput, replays: Sequence[Replayed]) -> list[Path]:
    """Write the signals beside the run's outcomes, with those of before, and its report again.

    Returns what was written. `UserError` where the folder cannot be written.
    """
    new = {replay.address: replay.signals for replay in replays if replay.signals}
    signals = dict(sorted({**source.signals, **new}.items()))
    write_file(folder / SIGNALS, encode_signals(signals), folder)
    provenance = amend(folder, source.provenance, [SIGNALS])
    source = replace(source, provenance=provenance, signals=signals)
    return [folder / SIGNALS, *write_report(source, folder)]
