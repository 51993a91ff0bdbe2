"""Who read what, when, over the first steps of a run, and where that is not as declared."""

from collections.abc import Iterable, Sequence
from typing import Literal

from faultpath.errors import UserError
from faultpath.faults import AnyFault
from faultpath.interface import Provenance
from faultpath.results import Result
from faultpath.review.flights import Flight, Flown, fly_here
from faultpath.review.gradient import Gradient, gradient
from faultpath.review.information import differences
from faultpath.text import unknown
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
    used: bool | None = None
    """Whether the module looked at it; `None` where the system runs a loop of its own."""


class Finding(Result):
    """A difference from what is declared."""

    says: str
    taps: tuple[tuple[str, str], ...] = ()
    """Channel and consumer."""


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
    gradient: Gradient | None = None
    """What autograd tells of paths past the taps; `None` where nothing is torch, or the system
    runs a loop of its own."""
    findings: tuple[Finding, ...] = ()


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
    found = list(_findings(system, variant, flown, steps))
    slopes = None
    if isinstance(system, LoopSystem):
        two = (chosen, *(each for each in known if each != chosen))[:2]
        slopes = gradient(system, variant, two, steps, seed)
        found += (Finding(says=said) for said in (slopes.found if slopes else ()))
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
        gradient=slopes,
        findings=tuple(found),
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
            used=read.used,
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
    for module, truth in sorted(flown.truths):
        yield f"Module '{module}' takes the plant's truth '{truth}' past all taps, as it declares."


def _findings(system: System, variant: str, flown: Flown, steps: int) -> Iterable[Finding]:
    found = differences(variant, flown)
    yield from (Finding(says=said, taps=taps) for said, taps in found.items())
    yield from (Finding(says=said) for said in _silent(system, variant, flown, steps))
    if flown.error:
        yield Finding(says=f"The run ended early: {flown.error}.")


def _silent(system: System, variant: str, flown: Flown, steps: int) -> Sequence[str]:
    """Name the consumers that are declared and read nothing in these steps."""
    read = {each.tap for each in flown.reads}
    return [
        f"Variant '{variant}' declares that {consumer} reads '{channel.name}', but in the first "
        f"{steps} steps it did not; trace more --steps, or take it out of the variant's consumers."
        for channel in system.interface.channels
        for consumer in channel.consumers
        if consumer in system.variants[variant].consumers and (channel.name, consumer) not in read
    ]
