"""Whether a fault at each tap reaches its reader, and whether the reader uses what it is handed."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from faultpath.interface import module_of
from faultpath.loop import Plant
from faultpath.run.attempt import Done
from faultpath.run.check.blocks import CheckRuns, RecordedBlock
from faultpath.run.check.results import Checked, Faulted, NothingChanged, Problem, Tap, TapFault
from faultpath.run.execution.recheck import deviation
from faultpath.system.loop_system import LoopSystem

HELD, MOVED = "held", "moved"
"""Runs in which a reader is handed constants: alone, and while all other readings are faulted."""


def reader_at(runs: CheckRuns, variant: str, tap: Tap) -> tuple[frozenset[Tap], frozenset[str]]:
    """Return all taps of the module that reads at a tap, and what it writes of these readings."""
    system, module = runs.system, module_of(tap[1])
    for part in system.loop(variant, None).graph.parts if isinstance(system, LoopSystem) else ():
        taps = frozenset((port.channel, part.reader(port)) for port in part.ports)
        if tap in taps:
            writes = part.senses if isinstance(part, Plant) else part.writes
            return taps, frozenset(() if getattr(part, "truths", ()) else writes)
    reads = runs.get(variant, "first").reads
    taps = frozenset(read.tap for read in reads if module_of(read.reader) == module)
    return taps, frozenset(system.interface.reconstructs.get(module, ()))


def unanswered(runs: CheckRuns) -> Iterator[tuple[str, Tap]]:
    """Yield each variant and tap where a fault altered readings and nothing else."""
    for (variant, why, tap), run in runs.recorded.items():
        if why != "tap" or run.error or not any(r.altered for r in run.reads if r.tap == tap):
            continue
        first = runs.get(variant, "first")
        ends = tuple(
            replace(outcome, faulted_steps=0, altered_steps=0, trajectory_hash="")
            for outcome in run.outcomes
        )
        alike = all(first.clean.get(key, value) == value for key, value in run.clean.items())
        if alike and not (ends and deviation(first.outcomes, Done(ends, ()))):
            yield variant, tap


def delivery(name: str, runs: CheckRuns) -> Checked:
    """Check that a fault at a tap alters what its reader gets, and that the reader uses it."""
    failures, remarks = list[Problem](), list[Problem]()
    altered, elsewhere = 0, 0
    alone = {key: run for key, run in runs.recorded.items() if key[1] == "tap"}
    silent = set(unanswered(runs))
    for (variant, _, tap), run in alone.items():
        fault = variant, tap, len(runs.scenes)
        here = [read for read in run.reads if read.tap == tap]
        count = sum(read.altered for read in here)
        altered += count
        others = [read for read in run.reads if read.tap != tap and read.altered]
        elsewhere += sum(read.altered for read in others)
        failures += [
            TapFault(*fault, "alters another tap", other=other)
            for other in dict.fromkeys(read.tap for read in others)
        ]
        if run.fails == name:
            failures.append(TapFault(*fault, "not delivered", run.error))
        elif not here:
            failures.append(TapFault(*fault, "not delivered"))
        elif not count:
            failures.append(TapFault(*fault, "alters nothing"))
        elif (variant, tap) in silent:
            problem = _without_effect(runs, variant, tap)
            (failures if problem.wrong == "reads elsewhere" else remarks).append(problem)
    remarks += [
        NothingChanged(variant, condition)
        for variant, condition, run in runs.under()
        if run.outcomes and not any(outcome.altered_steps for outcome in run.outcomes)
    ]
    summary = Faulted(len(alone), altered, elsewhere)
    return Checked(name, summary, tuple(failures), tuple(remarks))


def _without_effect(runs: CheckRuns, variant: str, tap: Tap) -> TapFault:
    """Return why a fault at a tap had no effect: its reader has its values from elsewhere where it
    was handed the same in two runs and wrote something else."""
    fault = variant, tap, len(runs.scenes)
    taps, writes = reader_at(runs, variant, tap)
    reads = runs.get(variant, "first").reads
    sources = {read.tap: read.source for read in reads}
    outputs = writes.intersection(sources.values())
    if not outputs:
        return TapFault(*fault, "no effect")
    pair = [runs.get(variant, why, min(taps)) for why in (HELD, MOVED)]
    queried = {read.source for read in reads if read.requests}  # answers depend on it
    handed = {scene: step for step, scene, at in _unlike(pair, "got")[::-1] if at in taps}
    for step, scene, at in _unlike(pair, "clean"):
        if sources[at] in outputs - queried and step < handed.get(scene, math.inf):
            changed = (sources[at],)
            return TapFault(*fault, "reads elsewhere", outputs=changed, step=step, scene=scene)
    return TapFault(*fault, "no effect", outputs=tuple(sorted(outputs)))


def _unlike(pair: Sequence[RecordedBlock], what: str) -> list[tuple[int, str, Tap]]:
    """Return step, scene and tap of what differs in two runs, as long as all their scenes ran."""
    ends = (outcome.steps(run.dt_s) for run in pair for outcome in run.outcomes)
    last = min(ends, default=0) if all(run.outcomes for run in pair) else 0
    one, two = (getattr(run, what) for run in pair)
    keys = (key for key in one.keys() & two.keys() if one[key] != two[key] and key[1] < last)
    return sorted((step, scene, (channel, reader)) for scene, step, channel, reader in keys)
