"""Whether a fault at each tap reaches its reader, and whether the reader uses what it is handed."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from faultpath.core.text import listed
from faultpath.interface import module_of
from faultpath.loop import Plant
from faultpath.run.attempt import Done
from faultpath.run.check.blocks import RecordedBlock
from faultpath.run.check.seen import Check, Seen
from faultpath.run.execution.recheck import deviation
from faultpath.system.loop_system import LoopSystem

HELD, MOVED = "held", "moved"
"""Runs in which a reader is handed constants: alone, and while all other readings are faulted."""


def reader_at(
    seen: Seen, variant: str, tap: tuple[str, str]
) -> tuple[frozenset[tuple[str, str]], frozenset[str]]:
    """Return all taps of the module that reads at a tap, and what it writes of these readings."""
    system, module = seen.system, module_of(tap[1])
    for part in system.loop(variant, None).graph.parts if isinstance(system, LoopSystem) else ():
        taps = frozenset((port.channel, part.reader(port)) for port in part.ports)
        if tap in taps:
            writes = part.senses if isinstance(part, Plant) else part.writes
            return taps, frozenset(() if getattr(part, "truths", ()) else writes)
    reads = seen.of(variant, "first").reads
    taps = frozenset(read.tap for read in reads if module_of(read.reader) == module)
    return taps, frozenset(system.interface.reconstructs.get(module, ()))


def unanswered(seen: Seen) -> Iterator[tuple[str, tuple[str, str]]]:
    """Yield each variant and tap where a fault altered readings and nothing else."""
    for (variant, why, tap), run in seen.runs.items():
        if why != "tap" or run.error or not any(r.altered for r in run.reads if r.tap == tap):
            continue
        first = seen.of(variant, "first")
        ends = tuple(
            replace(outcome, faulted_steps=0, altered_steps=0, trajectory_hash="")
            for outcome in run.outcomes
        )
        alike = all(first.clean.get(key, value) == value for key, value in run.clean.items())
        if alike and not (ends and deviation(first.outcomes, Done(ends, ()))):
            yield variant, tap


def delivery(name: str, seen: Seen) -> Check:
    """Check that a fault at a tap alters what its reader gets, and that the reader uses it."""
    failures, remarks = list[str](), list[str]()
    altered, elsewhere = 0, 0
    alone = {key: run for key, run in seen.runs.items() if key[1] == "tap"}
    silent = set(unanswered(seen))
    for (variant, _, tap), run in alone.items():
        lead = f"Injection point {tap[0]} -> {tap[1]} of variant '{variant}', faulted in "
        lead += f"{len(seen.scenes)} trials,"
        here = [read for read in run.reads if read.tap == tap]
        count = sum(read.altered for read in here)
        altered += count
        others = [read for read in run.reads if read.tap != tap and read.altered]
        elsewhere += sum(read.altered for read in others)
        for channel, reader in dict.fromkeys(read.tap for read in others):
            failures.append(
                f"{lead} altered a reading at {channel} -> {reader} too, which "
                "the fault does not name; trust no result of this version of faultpath, and report "
                "it."
            )
        if run.fails == name:
            failures.append(f"{lead} is not reached: {run.error}.")
        elif not here:
            failures.append(
                f"{lead} delivered nothing, though it did without the fault; deliver at every "
                "step that reads, and keep nothing from one call of run() to the next."
            )
        elif not count:
            failures.append(
                f"{lead} altered none of its readings; let the source hold numbers that a fault "
                "can change."
            )
        elif (variant, tap) in silent:
            passed, why = _effect(seen, variant, tap)
            (failures if passed else remarks).append(f"{lead} {why}")
    for label, run in seen.under():
        if run.outcomes and not any(outcome.altered_steps for outcome in run.outcomes):
            remarks.append(f"{label}: it changed no reading, so an audit would test nothing there.")
    says = f"{len(alone)} injection points, each faulted alone: {altered} readings altered, "
    says += f"{elsewhere} elsewhere" if elsewhere else "none elsewhere"
    return Check(name=name, says=says, failures=tuple(failures), remarks=tuple(remarks))


def _effect(seen: Seen, variant: str, tap: tuple[str, str]) -> tuple[bool, str]:
    """Return whether the reader at a tap has its values from elsewhere, and why a fault there had
    no effect. It has where it was handed the same in two runs and wrote something else."""
    taps, writes = reader_at(seen, variant, tap)
    reads = seen.of(variant, "first").reads
    sources = {read.tap: read.source for read in reads}
    output = writes.intersection(sources.values())
    if not output:
        return False, (
            "changed nothing else, in no outcome and at no other injection point, in the steps "
            "that were looked at; its module may use it later, or not at all, or may use something "
            "else than it was handed: a check can tell where the module writes a source."
        )
    module = module_of(tap[1])
    runs = [seen.of(variant, why, min(taps)) for why in (HELD, MOVED)]
    queried = {read.source for read in reads if read.asks}  # an answer depends on the request too
    handed = {scene: step for step, scene, at in _unlike(runs, "got")[::-1] if at in taps}
    for step, scene, at in _unlike(runs, "clean"):
        if sources[at] in output - queried and step < handed.get(scene, math.inf):
            return True, (
                f"had no effect, and '{module}' wrote another {sources[at]} at step {step} in "
                f"scene {scene!r} where all that it was handed was the same: it takes a value from "
                "elsewhere, past its injection points. Let it use what it is handed."
            )
    return False, (
        f"had no effect because the output of '{module}' never changed in any trial: "
        f"{listed(output)} stayed what it is without the fault. Look whether it uses this reading, "
        "and choose scenes in which that matters."
    )


def _unlike(runs: Sequence[RecordedBlock], what: str) -> list[tuple[int, str, tuple[str, str]]]:
    """Return step, scene and tap of what differs in two runs, as long as all their scenes ran."""
    ends = (outcome.steps(run.dt_s) for run in runs for outcome in run.outcomes)
    last = min(ends, default=0) if all(run.outcomes for run in runs) else 0
    one, two = (getattr(run, what) for run in runs)
    keys = (key for key in one.keys() & two.keys() if one[key] != two[key] and key[1] < last)
    return sorted((step, scene, (channel, reader)) for scene, step, channel, reader in keys)
