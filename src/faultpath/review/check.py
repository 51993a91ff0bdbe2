"""Fly a system as a careful reviewer would, and judge what was seen."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from faultpath.errors import UserError
from faultpath.execution.attempt import Died, Wrong
from faultpath.execution.flying import Flying
from faultpath.execution.limits import TimeLimit, memory_limit
from faultpath.execution.worker import Brief
from faultpath.faults import Fault, Scale
from faultpath.review import information, promises
from faultpath.review.fingerprint import fingerprint
from faultpath.review.flights import Flight, Flown, fly, fly_here, probe, unflown
from faultpath.review.report import Check, Report
from faultpath.review.seen import Seen
from faultpath.taps import Read
from faultpath.text import unknown
from faultpath.trials import Arm, Library, System, SystemSpec, Variant, library_of
from faultpath.trials.state import system_code
from faultpath.work import Executor, local

Note = Callable[[int, int | None], None]
"""Called with the flights done, and of how many once that is known."""

_FIRST = "first"

MOST = 4
"""So many variants are all checked unless some are named; of more the first two, or as many as the
user has named parts: a system puts those first that fly with them."""
_AFTER = 5
"""Control steps for which a tap is struck at first."""


@dataclass(frozen=True)
class Asked:
    """What to check, and with what."""

    variants: tuple[str, ...] = ()
    """Empty: all of them, or the first two of more than `MOST`."""
    library: str = "selection"
    scenes: int = 4
    seed: int = 0
    workers: int = 2
    """0: this process alone, which cannot see what differs from process to process."""
    time_limit_s: float | None = None


def check_system(system: System, spec: SystemSpec, asked: Asked, note: Note) -> Report:
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
    together = min(asked.scenes, system.block_size)  # an audit hands it no more at once either
    scenes = tuple(scene.id for scene in library.scenes[:together])
    seen = Seen(
        system, chosen_variants(system, asked.variants), scenes, asked.seed, asked.workers > 0
    )
    with local(asked.workers) as held:
        stable = fingerprint(system, spec, held)
        if stable.failures and asked.workers:  # a worker would refuse to fly another system
            return check_system(system, spec, replace(asked, workers=0, time_limit_s=None), note)
        limit = TimeLimit(system.time_limit_s if asked.time_limit_s is None else asked.time_limit_s)
        crew = _Crew(system, spec, library, limit, note)
        crew.fly(held, tuple(_first(seen)), seen)
    with local(asked.workers) as held:  # new processes: what is kept in one is not in the other
        crew.fly(held, tuple(_again(seen)), seen)
        crew.fly(held, tuple(_whole(seen)), seen)
    delivered, struck = information.delivery(seen)
    ended = promises.trials(seen)
    if together < asked.scenes:
        said = f"{ended.says}, in the first {together}: its block_size is {together}"
        ended = ended.model_copy(update={"says": said})
    checks = (
        ended,
        promises.determinism(seen),
        promises.independence(seen),
        promises.pairing(seen),
        information.reads(seen),
        delivered,
        information.readings(seen),
        _with_files(stable, crew.undeclared),
    )
    return Report(
        system=spec.name,
        options=spec.options,
        variants=tuple(variant.name for variant in seen.variants),
        library=library.name,
        scenes=scenes,
        seed=asked.seed,
        checks=checks,
        struck=struck,
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
    """Flies on an executor, and takes down what was seen."""

    def __init__(
        self, system: System, spec: SystemSpec, library: Library, limit: TimeLimit, note: Note
    ) -> None:
        self._system, self._name, self._limit, self._note = system, spec.name, limit, note
        state = system_code(system, spec).state
        memory_gib = memory_limit(None, system.memory_limit_gib)
        self._brief = Brief(spec, library.name, state, library.content_hash, memory_gib)
        self._done, self._known = 0, 0
        self.undeclared = set[str]()
        """Files that were read and not named."""

    def fly(self, held: Executor, flights: Sequence[Flight], seen: Seen) -> None:
        """Fly all of some flights."""
        self._known += len(flights)
        waiting = list(flights)

        def take(worker: int) -> Flight | None:
            return waiting.pop(0) if waiting else None

        def settle(flight: Flight, reply: Flown | Died | Wrong) -> None:
            flown = reply if isinstance(reply, Flown) else unflown(reply)
            seen.flights[flight.variant, flight.why] = flight, flown
            self._done += 1
            self._note(self._done, None if flight.why == _FIRST else self._known)

        here, there = partial(fly_here, self._system), partial(fly, self._brief)
        call = here if held.in_process else there
        flying = Flying[Flight](held, lambda flight: partial(call, flight), self._limit, self._name)
        flying.run(take, settle, lambda: None)
        self.undeclared |= flying.undeclared


def _first(seen: Seen) -> Iterable[Flight]:
    for variant in seen.variants:
        yield Flight(_FIRST, Arm(variant=variant.name, seed=seen.seed), seen.scenes)


def _again(seen: Seen) -> Iterable[Flight]:
    scenes = seen.scenes
    for name, first in seen.firsts():
        arm = Arm(variant=name, seed=seen.seed)
        yield Flight("again", arm, scenes)
        yield Flight("turned", arm, scenes[::-1])
        if len(scenes) > 1:
            yield Flight("part", arm, scenes[1::2])
        begins: dict[tuple[str, str], Read] = {}
        for read in first.reads:
            if read.given and read.tap not in first.refused:
                begins.setdefault(read.tap, read)
        if fault := _shared(tuple(begins.values())):
            yield Flight("faulted", _struck(seen, arm, fault), scenes)
        for (channel, consumer), read in begins.items():
            faulty = _struck(seen, arm, probe(read))
            yield Flight(f"struck {channel} {consumer}", faulty, scenes, read.step + _AFTER)


def _whole(seen: Seen) -> Iterable[Flight]:
    for (variant, why), (flight, flown) in tuple(seen.flights.items()):
        if not why.startswith("struck") or flown.error or not any(r.altered for r in flown.reads):
            continue
        if not information.effective(seen, variant, flown):
            yield Flight(f"{why} whole", flight.arm, flight.scenes)


def _shared(reads: Sequence[Read]) -> Fault | None:
    readers: dict[str, list[str]] = {}
    for read in reads:
        if "float" in read.dtype:
            readers.setdefault(read.channel, []).append(read.consumer)
    if not readers:
        return None
    most = max(readers, key=lambda channel: len(readers[channel]))
    return Fault(channel=most, intervention=Scale(factor=1.05), consumers=tuple(readers[most]))


def _struck(seen: Seen, arm: Arm, fault: Fault) -> Arm:
    return arm.model_copy(update={"faults": fault.resolved(seen.system.interface)})


def _with_files(stable: Check, undeclared: Iterable[str]) -> Check:
    """Add files that were read and whose change nobody would notice."""
    failures = tuple(
        f"{path} is read and not named: a change there would not be noticed; name it in the "
        "property data_files."
        for path in sorted(undeclared)
    )
    return stable.model_copy(update={"failures": (*stable.failures, *failures)})
