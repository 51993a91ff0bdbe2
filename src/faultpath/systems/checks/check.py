"""Run a system as a careful reviewer would, and judge what was seen."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import Literal

from faultpath.core.errors import UserError
from faultpath.core.results import Result
from faultpath.core.text import unknown
from faultpath.faults import AnyFault, Erase, Fault, Offset, Scale
from faultpath.faults import Sequence as InTurn
from faultpath.systems.checks import judging
from faultpath.systems.checks.flights import Flight, Flown, Read, fly, fly_here, lost
from faultpath.systems.checks.judging import Check, Seen
from faultpath.trials import Arm, System, SystemSpec, Variant, library_of
from faultpath.trials.attempt import Died, Wrong
from faultpath.trials.execution.dispatch import Dispatch, block_limit_s
from faultpath.trials.execution.worker import Job
from faultpath.trials.question import CheckQuestion
from faultpath.trials.state import system_code
from faultpath.trials.work import local

MOST = 4
"""So many variants are all checked unless some are named; of more the first two, or as many as the
user has named parts: a system puts those first that run with them."""
_AFTER = 20
"""Control steps for which a tap is faulted."""


class Report(Result):
    """A check of a system; what `faultpath check --json` prints."""

    format: Literal[2] = 2
    system: str
    options: dict[str, str]
    variants: tuple[str, ...]
    library: str
    scenes: tuple[str, ...]
    seed: int
    checks: tuple[Check, ...]

    @property
    def failures(self) -> tuple[str, ...]:
        """The sentences of all checks that failed."""
        return tuple(said for check in self.checks for said in check.failures)


def check_system(
    system: System,
    spec: SystemSpec,
    asked: CheckQuestion,
    note: Callable[[int, int | None], None],
) -> Report:
    """Check a system: what it promises, what it reads, and that faults reach it.

    `note` is called with the runs done, and of how many once that is known. Raises `UserError` for
    a variant, library or number of scenes that there is not, and where the system cannot be built
    in a worker process.
    """
    library = library_of(system, asked.library)
    if not 1 <= asked.scenes <= len(library.scenes):
        raise UserError(
            f"cannot check {asked.scenes} scenes of library '{library.name}': choose 1 to "
            f"{len(library.scenes)}."
        )
    scenes = tuple(scene.id for scene in library.scenes[: asked.scenes])
    variants = chosen_variants(system, asked.variants)
    workers = (2 if system.parallel else 1) if asked.workers is None else asked.workers
    seen = Seen(system, variants, scenes, asked.seed, workers > 0)
    job = Job(spec, library.name, system_code(system, spec).state, library.content_hash)
    limit_s = block_limit_s(system, None)

    def run(flights: Iterable[Flight], known: int | None) -> None:
        waiting = iter(flights)

        def settle(flight: Flight, reply: Flown | Died | Wrong) -> None:
            flown = reply if isinstance(reply, Flown) else lost(reply)
            seen.flights[flight.arm.variant, flight.why, flight.tap] = flown
            note(len(seen.flights), known)

        with local(workers) as held:
            call = partial(fly_here, system) if held.in_process else partial(fly, job)
            dispatch = Dispatch[Flight](held, lambda each: partial(call, each), limit_s, spec.name)
            dispatch.run(lambda _: next(waiting, None), settle)

    run((Flight("first", Arm(variant=v.name, seed=asked.seed), scenes) for v in variants), None)
    again = list(_again(seen))
    run(again, len(variants) + len(again))  # in new processes: they share nothing with the first
    return Report(
        system=spec.name,
        options=spec.options,
        variants=tuple(variant.name for variant in variants),
        library=library.name,
        scenes=scenes,
        seed=asked.seed,
        checks=judging.checks(seen),
    )


def chosen_variants(system: System, names: Sequence[str]) -> tuple[Variant, ...]:
    """Return the variants of these names; of none those that a check runs unasked."""
    every = system.variants
    for name in names:
        if name not in every:
            raise UserError(f"{system.name}: {unknown('variant', name, every)}")
    few = len(every) if len(every) <= MOST else max(2, len(system.parts))
    chosen = tuple(names) or tuple(every)[:few]
    return tuple(every[name] for name in dict.fromkeys(chosen))


def _again(seen: Seen) -> Iterator[Flight]:
    """Yield what is run of each variant beside its first flight."""
    for name, first in seen.firsts():

        def arm(*faults: AnyFault, name: str = name) -> Arm:
            return Arm(variant=name, seed=seen.seed, faults=faults)

        def faulted(fault: Fault, name: str = name) -> Arm:
            present = seen.system.variants[name].consumers
            return arm(*fault.resolved(seen.system.interface, present))

        yield Flight("again", arm(), seen.scenes)
        if len(seen.scenes) > 1:
            yield Flight("part", arm(), seen.scenes[::-2])
        begins: dict[tuple[str, str], Read] = {}
        for read in first.reads:
            if read.given:
                begins.setdefault(read.tap, read)
        readers: dict[str, list[str]] = {}
        for (channel, consumer), read in begins.items():
            if "float" in read.dtype:
                readers.setdefault(channel, []).append(consumer)
        if readers:
            most = max(readers, key=lambda channel: len(readers[channel]))
            doing, at = Scale(factor=1.05), tuple(readers[most])
            shared = Fault(channel=most, intervention=doing, consumers=at)
            yield Flight("faulted", faulted(shared), seen.scenes)
        for (channel, consumer), read in begins.items():  # one that alters whatever it delivers
            if "float" in read.dtype:
                doing = InTurn(parts=(Scale(factor=1.5), Offset(by=0.25)))
            else:  # keeps whole numbers and truths what they are
                doing = Erase(default=1.0 - read.low if read.dtype == "bool" else read.high + 1.0)
            alone = Fault(channel=channel, intervention=doing, consumers=(consumer,))
            yield Flight("tap", faulted(alone), seen.scenes, read.step + _AFTER, read.tap)
