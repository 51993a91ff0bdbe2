"""Run a system as a careful reviewer would, and judge what was seen."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Literal

from faultpath.core.errors import UserError
from faultpath.core.results import Result
from faultpath.core.text import unknown
from faultpath.faults import Fault, Offset, Replace, Scale
from faultpath.faults import Sequence as InTurn
from faultpath.systems.checks import judging
from faultpath.systems.checks.flights import Flight, Flown, Read, fly, fly_here, unflown
from faultpath.systems.checks.judging import Check, Seen
from faultpath.trials import Arm, Library, System, SystemSpec, Variant, library_of
from faultpath.trials.attempt import Died, Wrong
from faultpath.trials.execution.dispatch import Dispatch, block_limit_s
from faultpath.trials.execution.worker import Job
from faultpath.trials.question import CheckQuestion
from faultpath.trials.state import system_code
from faultpath.trials.work import Executor, local

Note = Callable[[int, int | None], None]
"""Called with the flights done, and of how many once that is known."""

MOST = 4
"""So many variants are all checked unless some are named; of more the first two, or as many as the
user has named parts: a system puts those first that fly with them."""
_AFTER = 20
"""Control steps for which a tap is struck."""


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


def check_system(system: System, spec: SystemSpec, asked: CheckQuestion, note: Note) -> Report:
    """Check a system: what it promises, what it reads, and that faults reach it.

    Raises `UserError` for a variant, library or number of scenes that there is not, and where the
    system cannot be built in a worker process.
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
    limit_s = block_limit_s(system, asked.time_limit_s)
    crew = _Crew(system, spec, library, limit_s, note)
    with local(workers) as held:
        arms = [Arm(variant=variant.name, seed=asked.seed) for variant in variants]
        crew.fly(held, [Flight("first", arm, scenes) for arm in arms], seen)
    with local(workers) as held:  # new processes: what is kept in one is not in the other
        crew.fly(held, list(_again(seen)), seen)
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
    """Return the variants of these names; of none those that a check flies unasked."""
    every = system.variants
    for name in names:
        if name not in every:
            raise UserError(f"{system.name}: {unknown('variant', name, every)}")
    few = len(every) if len(every) <= MOST else max(2, len(system.parts))
    chosen = tuple(names) or tuple(every)[:few]
    return tuple(every[name] for name in dict.fromkeys(chosen))


class _Crew:
    """Runs flights on an executor, and notes what was seen."""

    def __init__(
        self, system: System, spec: SystemSpec, library: Library, limit_s: float, note: Note
    ) -> None:
        self._system, self._name, self._limit_s, self._note = system, spec.name, limit_s, note
        state = system_code(system, spec).state
        self._job = Job(spec, library.name, state, library.content_hash)
        self._done, self._known = 0, 0

    def fly(self, held: Executor, flights: Sequence[Flight], seen: Seen) -> None:
        self._known += len(flights)
        waiting = list(flights)

        def settle(flight: Flight, reply: Flown | Died | Wrong) -> None:
            flown = reply if isinstance(reply, Flown) else unflown(reply)
            seen.flights[flight.arm.variant, flight.why, flight.tap] = flight, flown
            self._done += 1
            self._note(self._done, None if flight.why == "first" else self._known)

        call = partial(fly_here, self._system) if held.in_process else partial(fly, self._job)
        dispatch = Dispatch[Flight](
            held, lambda flight: partial(call, flight), self._limit_s, self._name
        )
        dispatch.run(lambda _: waiting.pop(0) if waiting else None, settle)


def _again(seen: Seen) -> Iterator[Flight]:
    """Yield what is flown of each variant beside its first flight."""
    scenes = seen.scenes
    for name, first in seen.firsts():
        arm = Arm(variant=name, seed=seen.seed)
        yield Flight("again", arm, scenes)
        if len(scenes) > 1:
            yield Flight("part", arm, scenes[::-2])
        begins: dict[tuple[str, str], Read] = {}
        for read in first.reads:
            if read.given:
                begins.setdefault(read.tap, read)
        probes = {tap: _probe(read) for tap, read in begins.items()}
        readers: dict[str, list[str]] = {}
        for (channel, consumer), read in begins.items():
            if "float" in read.dtype:
                readers.setdefault(channel, []).append(consumer)
        if readers:
            most = max(readers, key=lambda channel: len(readers[channel]))
            doing, at = Scale(factor=1.05), tuple(readers[most])
            shared = Fault(channel=most, intervention=doing, consumers=at)
            yield Flight("faulted", _struck(seen, arm, shared), scenes)
        for tap, fault in probes.items():
            stop = begins[tap].step + _AFTER
            yield Flight("struck", _struck(seen, arm, fault), scenes, stop, tap)


def _probe(read: Read) -> Fault:
    """Return a fault that alters whatever a tap delivers, struck alone."""
    if "float" in read.dtype:
        doing = InTurn(parts=(Scale(factor=1.5), Offset(by=0.25)))
    else:  # that keeps whole numbers and truths what they are
        doing = Replace(value=1.0 - read.low if read.dtype == "bool" else read.high + 1.0)
    return Fault(channel=read.channel, intervention=doing, consumers=(read.consumer,))


def _struck(seen: Seen, arm: Arm, fault: Fault) -> Arm:
    present = seen.system.variants[arm.variant].consumers
    return arm.model_copy(update={"faults": fault.resolved(seen.system.interface, present)})
