"""Trace of who read what, when, in the first steps of a run, and where that is not as declared."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, Literal, TypeAlias, TypeVar

from faultpath.core.errors import UserError
from faultpath.core.results import Result
from faultpath.core.text import unknown
from faultpath.faults import describe, reaching
from faultpath.interface import module_of
from faultpath.run.check.blocks import BlockSpec, run_block
from faultpath.run.check.check import chosen_variants
from faultpath.run.check.reads import Read
from faultpath.run.plan import SystemSpec, Treatment
from faultpath.run.question import TraceQuestion
from faultpath.system.checks import library_of
from faultpath.system.loop_system import LoopSystem
from faultpath.system.system import System

_Told = TypeVar("_Told")


class TracedRead(Result):
    """A delivery of one channel to one reader in one control step."""

    step: int
    reader: str
    channel: str
    source: str
    valid_step: int
    """Step of the reading, as that of `Read`."""
    requests: int = 0
    """Answers that the reader got of a query."""
    altered_by: tuple[str, ...] = ()
    """Faults at the tap, where what was delivered differs from the reading."""


@dataclass(frozen=True)
class NeverRead:
    """A reader that a variant declares, and that did not read in the steps of a trace."""

    variant: str
    channel: str
    reader: str
    steps: int


@dataclass(frozen=True)
class EndedEarly:
    """An error that ended a run before the steps of its trace."""

    error: str


@dataclass(frozen=True)
class PermittedRead:
    """A read of a privileged source, by permission of the variant."""

    reader: str
    source: str


@dataclass(frozen=True)
class TruthRead:
    """A module that takes a truth of the plant past all taps."""

    module: str
    truth: str


TraceFinding: TypeAlias = NeverRead | EndedEarly | PermittedRead | TruthRead


class Trace(Result, Generic[_Told]):
    """A trace of a variant, whose findings are data or words."""

    format: Literal[1] = 1
    system: str
    options: dict[str, str]
    variant: str
    library: str
    scene: str
    seed: int
    steps: int
    fault: str = ""
    reads: tuple[TracedRead, ...]
    """In the order in which they happened."""
    reconstructed: dict[str, tuple[str, tuple[str, ...]]]
    """Source to the module that reconstructs it and the channels that this one read."""
    privileged: tuple[_Told, ...] = ()
    """Reads of what deployment does not have, by permission of the variant or past all taps."""
    findings: tuple[_Told, ...] = ()
    """Differences from what is declared."""


def trace_system(system: System, spec: SystemSpec, question: TraceQuestion) -> Trace[TraceFinding]:
    """Run a variant for a few steps and report what was read.

    Raises `UserError` for a variant, library or scene that there is not, a fault that
    reaches no reader there, and a run that fails.
    """
    variant, steps = question.variant or next(iter(system.variants)), question.steps
    readers = chosen_variants(system, (variant,))[0].readers
    library = library_of(system, question.library)
    known = [scene.id for scene in library.scenes]
    scene = known[0] if question.scene is None else question.scene
    if scene not in known:
        raise UserError(f"library '{library.name}': {unknown('scene', scene, known)}")
    faults = () if question.fault is None else system.fault(question.fault)
    faults = reaching(faults, readers)
    treatment = Treatment(variant=variant, faults=faults, seed=question.seed)
    run = run_block(system, BlockSpec(treatment, (scene,), steps=steps))
    if run.error and not run.reads:
        raise UserError(f"variant '{variant}' does not run: {run.error}")
    taps = {read.tap for read in run.reads}
    findings: tuple[TraceFinding, ...] = tuple(
        NeverRead(variant, channel.name, reader, steps)
        for channel in system.interface.channels
        for reader in channel.readers
        if reader in readers and (channel.name, reader) not in taps
    )
    if run.error:
        findings = (EndedEarly(run.error),)
    words: dict[tuple[str, str], list[str]] = {}
    for fault in faults:
        for reader in fault.readers:
            words.setdefault((fault.channel, reader), []).append(fault.intervention.words())
    return Trace[TraceFinding](
        system=spec.name,
        options=spec.options,
        variant=variant,
        library=library.name,
        scene=scene,
        seed=question.seed,
        steps=steps,
        fault=describe(faults),
        reads=tuple(
            TracedRead(
                step=read.step,
                reader=read.reader,
                channel=read.channel,
                source=read.source,
                valid_step=read.valid_step,
                requests=read.requests,
                altered_by=tuple(words[read.tap]) if read.altered else (),
            )
            for read in run.reads
        ),
        reconstructed=_reconstructed(system, run.reads),
        privileged=_privileged(system, variant, run.reads),
        findings=findings,
    )


def _reconstructed(system: System, reads: Sequence[Read]) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Return by reconstructed source that was read its module and what that module read."""
    sources = {read.source for read in reads}
    readers: dict[str, dict[str, None]] = {}
    for read in reads:
        readers.setdefault(module_of(read.reader), {})[read.channel] = None
    return {
        source: (module, tuple(readers.get(module, ())))
        for module, source in system.interface.reconstructions
        if source in sources
    }


def _privileged(system: System, variant: str, reads: Sequence[Read]) -> tuple[TraceFinding, ...]:
    """Return each read of what deployment does not have."""
    permitted = system.variants[variant].privileged
    by_permission = {read.reader: read.source for read in reads if read.source in permitted}
    modules = system.modules(variant, None) if isinstance(system, LoopSystem) else ()
    return (
        *(PermittedRead(reader, source) for reader, source in by_permission.items()),
        *(TruthRead(module.name, truth) for module in modules for truth in sorted(module.truths)),
    )
