"""Trace of who read what, when, in the first steps of a run, and where that is not as declared."""

from collections.abc import Sequence

from faultpath.core.errors import UserError
from faultpath.core.text import unknown
from faultpath.faults import describe, reaching
from faultpath.interface import module_of
from faultpath.run import SystemSpec, Treatment
from faultpath.run.check.blocks import BlockSpec, run_block
from faultpath.run.check.check import chosen_variants
from faultpath.run.check.reads import Read
from faultpath.run.check.results import (
    EndedEarly,
    NeverRead,
    PermittedRead,
    Trace,
    TracedRead,
    TraceFinding,
    TruthRead,
)
from faultpath.run.question import TraceQuestion
from faultpath.system.checks import library_of
from faultpath.system.loop_system import LoopSystem
from faultpath.system.system import System


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
    words = {
        (fault.channel, reader): fault.intervention.words()
        for fault in faults
        for reader in fault.readers
    }
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
                asks=read.asks,
                altered_by=(words[read.tap],) if read.altered else (),
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
