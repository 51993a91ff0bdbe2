"""Who read what, when, over the first steps of a run, and where that is not as declared."""

from collections.abc import Iterable
from typing import Literal

from faultpath.core.errors import UserError
from faultpath.core.results import Result
from faultpath.core.text import unknown
from faultpath.faults import AnyFault
from faultpath.interface import Provenance
from faultpath.systems.checks.flights import Flight, Flown, fly_here
from faultpath.trials import Arm, LoopSystem, System, SystemSpec, library_of


class TracedRead(Result):
    """One read: a consumer, a channel and a control step."""

    step: int
    consumer: str
    channel: str
    source: str
    valid_step: int
    """Step of the reading: before `step` for what is late, held or read of the past; -1 is what
    the source held before the first step."""
    asks: int = 0
    """Answers that the consumer got of a query."""
    altered_by: tuple[str, ...] = ()
    """Faults that strike the tap, where what was delivered differs from the reading."""


class TraceReport(Result):
    """A trace of a variant; what `faultpath trace --json` prints."""

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
    privileged: tuple[str, ...] = ()
    """Reads of what deployment does not have, by permission of the variant or past all taps."""
    findings: tuple[str, ...] = ()
    """Differences from what is declared, a sentence each."""


def trace_system(
    system: System,
    spec: SystemSpec,
    variant: str,
    library: str = "selection",
    scene: str | None = None,
    steps: int = 3,
    seed: int = 0,
    fault: AnyFault | None = None,
) -> TraceReport:
    """Run a variant for a few steps and tell what was read.

    Raises `UserError` for a variant, library or scene that there is not, a fault that strikes
    nobody there, and a run that fails.
    """
    if variant not in system.variants:
        raise UserError(f"{system.name}: {unknown('variant', variant, system.variants)}")
    known = [each.id for each in library_of(system, library).scenes]
    chosen = known[0] if scene is None else scene
    if chosen not in known:
        raise UserError(f"library '{library}': {unknown('scene', chosen, known)}")
    consumers = system.variants[variant].consumers
    faults = () if fault is None else fault.resolved(system.interface, consumers)
    if fault is not None and not faults:
        raise UserError(f"the fault ({fault.describe()}) strikes nobody in variant '{variant}'.")
    arm = Arm(variant=variant, faults=faults, seed=seed)
    flown = fly_here(system, Flight("trace", arm, (chosen,), steps))
    if flown.error and not flown.reads:
        raise UserError(f"variant '{variant}' does not run: {flown.error}")
    read = {each.tap for each in flown.reads}
    findings = [
        f"Variant '{variant}' declares that {consumer} reads '{channel.name}', but in the first "
        f"{steps} steps it did not; trace more --steps, or take it out of the variant's consumers."
        for channel in system.interface.channels
        for consumer in channel.consumers
        if consumer in consumers and (channel.name, consumer) not in read
    ]
    if flown.error:
        findings = [f"The run ended early: {flown.error}."]
    return TraceReport(
        system=spec.name,
        options=spec.options,
        variant=variant,
        library=library,
        scene=chosen,
        seed=seed,
        steps=steps,
        fault="" if fault is None else fault.describe(),
        reads=tuple(_reads(flown, arm)),
        reconstructed=_reconstructed(system, flown),
        privileged=tuple(_privileged(system, variant, flown)),
        findings=tuple(findings),
    )


def _reads(flown: Flown, arm: Arm) -> Iterable[TracedRead]:
    strikes = {
        (fault.channel, consumer): fault
        for declared in arm.faults
        for fault in (declared.faults if declared.kind == "coupled" else (declared,))
        for consumer in fault.consumers
    }
    for read in flown.reads:
        yield TracedRead(
            step=read.step,
            consumer=read.consumer,
            channel=read.channel,
            source=read.source,
            valid_step=read.valid_step,
            asks=read.asks,
            altered_by=(strikes[read.tap].intervention.words(),) if read.altered else (),
        )


def _reconstructed(system: System, flown: Flown) -> dict[str, tuple[str, tuple[str, ...]]]:
    read = {each.source for each in flown.reads}
    return {
        source: (
            module,
            tuple(
                dict.fromkeys(
                    each.channel
                    for each in flown.reads
                    if each.consumer.partition(".")[0] == module
                )
            ),
        )
        for module, source in system.interface.reconstructions
        if source in read
    }


def _privileged(system: System, variant: str, flown: Flown) -> Iterable[str]:
    """Say what is read by permission, or by declaration past all taps."""
    secret = {
        source.name
        for source in system.interface.sources
        if source.provenance is Provenance.PRIVILEGED
    }
    allowed = {each.consumer: each.source for each in flown.reads if each.source in secret}
    for consumer, source in allowed.items():
        if source in system.variants[variant].privileged:
            yield f"{consumer} reads '{source}', which is privileged, by permission of the variant."
    modules = system.modules(variant, None) if isinstance(system, LoopSystem) else ()
    for module in modules:
        for truth in sorted(module.truths):
            yield f"Module '{module.name}' takes the plant's truth '{truth}' past all taps."
