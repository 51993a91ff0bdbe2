"""Flying trials of a finished run again: whether they come out as they did, and what was heard."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

from faultpath.door.saved import read_run
from faultpath.door.systems import choose
from faultpath.errors import UserError
from faultpath.execution.attempt import Done, Raised
from faultpath.execution.differences import difference
from faultpath.faults import parse_fault
from faultpath.planning import plan_audit
from faultpath.report.html import write_report
from faultpath.report.inputs import ReportInput
from faultpath.report.pairing import by_scene, read_pairs
from faultpath.report.viewer_choice import choose as picked
from faultpath.review.hearing import Heard, fly_heard, signals
from faultpath.store import TrialAddress, write_text
from faultpath.store.atomic import write_file
from faultpath.store.sealed import seal
from faultpath.store.signals import SIGNALS, Signal, encode_signals
from faultpath.text import unknown
from faultpath.trials import Outcome, System, SystemSpec, library_of

More: TypeAlias = Callable[[System, Heard, Done], list[tuple[Signal, ...]]]
"""What a system says beside what is heard, by scene."""


@dataclass(frozen=True)
class Replayed:
    """One trial, flown again."""

    address: TrialAddress
    outcome: Outcome
    """Of the run."""
    differs: str
    """How the second flight differs; empty where it is the same to the bit."""
    signals: tuple[Signal, ...] = ()


def chosen_scenes(
    held: ReportInput, scenes: Sequence[str], paths: Sequence[str]
) -> tuple[str, ...]:
    """Return the scenes to fly again, by default those that the report begins with.

    `UserError` for a scene or path that the run has not got.
    """
    flown = list(dict.fromkeys(row.outcome.scene for row in held.outcomes.rows))
    named = [path.name for path in held.record.paths]
    for what, asked, known in (("scene", scenes, flown), ("path", paths, named)):
        for name in asked:
            if name not in known:
                raise UserError(f"the run: {unknown(what, name, known)}")
    if scenes:
        return tuple(dict.fromkeys(scenes))
    pairs = read_pairs(held.outcomes, held.record)
    few = [showing.any_pair.scene for showing in picked(held.record, held.traces, pairs)]
    return tuple(few or [scene for scene, _ in by_scene(pairs)][:1])


def replay(
    held: ReportInput,
    scenes: Sequence[str],
    paths: Sequence[str] = (),
    more: Mapping[str, More] | None = None,
    tell: Callable[[str], None] = lambda said: None,
) -> list[Replayed]:
    """Fly the trials of some scenes again, on all paths or on some, in both arms.

    `more` has what systems say beside what is heard, by the name of the system. Raises `UserError`
    where the system cannot be built, or no longer has the scenes and variants of the run.
    """
    asked = held.record.question
    if SystemSpec(name=asked.system).is_object:
        raise UserError(
            f"the run flew a {asked.system}, which only its own process had: put what builds the "
            "system into a file, and audit that."
        )
    chosen = choose(asked.system, asked.options, None, (asked.baseline, asked.repair))
    system = chosen.system
    library = library_of(system, asked.library)
    if library.content_hash != asked.library_hash:
        raise UserError(
            f"library '{asked.library}' has other scenes than the run flew: bring its file back."
        )
    fault = parse_fault(asked.fault, system.interface, system.fault_presets, system.control_dt_s)
    study = plan_audit(
        system,
        chosen.spec,
        baseline=asked.baseline,
        repair=asked.repair,
        fault=fault,
        fault_text=asked.fault,
        library=library,
        seeds=asked.seeds,
    ).study
    flown = {
        (at := TrialAddress(row.variant, row.path, row.seed, row.outcome.scene)): replace(
            row.outcome, trace=held.traces.positions.get(at)
        )
        for row in held.outcomes.rows
    }
    said = (more or {}).get(asked.system)
    found: list[Replayed] = []
    for row in study.rows:
        if paths and row.path not in paths:
            continue
        addresses = [TrialAddress(row.variant, row.path, row.seed, scene) for scene in scenes]
        first = [at for at in addresses if at in flown and not flown[at].failed]
        if not first:
            continue
        tell(f"Flying {row.variant}, {row.path}, seed {row.seed}, again.")
        done, heard = fly_heard(system, row.arm, [at.scene for at in first])
        before = [flown[at] for at in first]
        if not isinstance(done, Done):
            error = done.error if isinstance(done, Raised) else str(done.error)
            found += [Replayed(at, flown[at], f"failed: {error}") for at in first]
            continue
        named = signals(heard, done, system.control_dt_s)
        if said is not None:
            named = [a + b for a, b in zip(named, said(system, heard, done), strict=True)]
        for at, was, now, each in zip(first, before, done.outcomes, named, strict=True):
            differs = difference([was], Done((now,), (), 0.0))
            found.append(Replayed(at, was, differs, () if differs else each))
    return found


def keep_signals(folder: Path, held: ReportInput, found: Sequence[Replayed]) -> list[Path]:
    """Write the signals beside the run's outcomes, with those of before, and its report again.

    Returns what was written. `UserError` where the folder cannot be written.
    """
    signals = {**held.signals, **{each.address: each.signals for each in found if each.signals}}
    write_file(folder / SIGNALS, encode_signals(dict(sorted(signals.items()))), folder)
    files = {**held.provenance.files, **seal(folder, [SIGNALS])}
    sealed = held.provenance.model_copy(update={"files": files})
    write_text(folder / "provenance.json", sealed.model_dump_json(indent=2) + "\n", folder)
    return [folder / SIGNALS, *write_report(read_run(folder)[0], folder)]
