"""Run a system as a careful reviewer would, and judge what was seen."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Literal

from faultpath.core.errors import UserError
from faultpath.core.results import Result
from faultpath.core.text import unknown
from faultpath.faults import AnyIntervention, Erase, Fault, Offset, Scale
from faultpath.faults import Sequence as InTurn
from faultpath.systems.checks.blocks import BlockSpec, RecordedBlock, coarsest, run_blocks
from faultpath.systems.checks.judging import Check, Seen, judged
from faultpath.systems.checks.recording import Read
from faultpath.trials import Arm, System, SystemSpec, Variant, library_of
from faultpath.trials.execution.dispatch import Built
from faultpath.trials.question import CheckQuestion
from faultpath.trials.work.processes import local

MOST = 4
"""A system of up to so many variants is checked whole, unless some are named; of a larger one the
first two, or one for each part of the user's own: a system lists those that run with them first."""
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
        return tuple(sentence for check in self.checks for sentence in check.failures)


def check_system(
    system: System,
    spec: SystemSpec,
    question: CheckQuestion,
    note: Callable[[int, int | None], None],
) -> Report:
    """Check a system: what it promises, what it reads, and that faults reach it.

    `note` is called with the runs done, and of how many once that is known. Raises `UserError` for
    a variant, library or number of scenes that there is not, and where the system cannot be built
    in a worker process.
    """
    library = library_of(system, question.library)
    if not 1 <= question.scenes <= len(library.scenes):
        raise UserError(
            f"cannot check {question.scenes} scenes of library '{library.name}': choose 1 to "
            f"{len(library.scenes)}."
        )
    scenes = tuple(scene.id for scene in library.scenes[: question.scenes])
    variants = chosen_variants(system, question.variants)
    workers = (2 if system.parallel else 1) if question.workers is None else question.workers
    seen = Seen(system, variants, scenes, question.seed, workers > 0)
    built = Built.of(system, spec, question.library)

    def run(blocks: Sequence[BlockSpec], known: int | None) -> None:
        def settle(block: BlockSpec, result: RecordedBlock) -> None:
            seen.runs[block.arm.variant, block.why, block.tap] = result
            note(len(seen.runs), known)

        with local(workers) as executor:
            run_blocks(executor, built, blocks, settle)

    run(
        [BlockSpec(Arm(variant=v.name, seed=question.seed), scenes, "first") for v in variants],
        None,
    )
    again = [block for name, first in seen.firsts() for block in _again(seen, name, first)]
    run(again, len(variants) + len(again))  # in new processes: they share nothing with the first
    rounded = [block for name, first in seen.firsts() for block in _rounded(seen, name, first)]
    if rounded:
        run(rounded, len(variants) + len(again) + len(rounded))
    return Report(
        system=spec.name,
        options=spec.options,
        variants=tuple(variant.name for variant in variants),
        library=library.name,
        scenes=scenes,
        seed=question.seed,
        checks=judged(seen),
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


def _again(seen: Seen, variant: str, first: RecordedBlock) -> Iterator[BlockSpec]:
    """Yield what is run of a variant beside its first run."""
    arm = Arm(variant=variant, seed=seen.seed)
    yield BlockSpec(arm, seen.scenes, "again")
    if len(seen.scenes) > 1:
        yield BlockSpec(arm, seen.scenes[::-2], "part")
    begins, readers = _begun(first)
    if readers:
        most = max(readers, key=lambda channel: len(readers[channel]))
        arm = _faulted(seen, variant, {most: readers[most]}, Scale(factor=1.05))
        yield BlockSpec(arm, seen.scenes, "faulted")
    for (channel, consumer), read in begins.items():
        if "float" in read.dtype:  # alters whatever it delivers
            doing = InTurn(parts=(Scale(factor=1.5), Offset(by=0.25)))
        else:  # keeps whole numbers and truths what they are
            doing = Erase(default=1.0 - read.low if read.dtype == "bool" else read.high + 1.0)
        alone = _faulted(seen, variant, {channel: (consumer,)}, doing)
        yield BlockSpec(alone, seen.scenes, "tap", read.step + _AFTER, read.tap)


def _rounded(seen: Seen, variant: str, first: RecordedBlock) -> Iterator[BlockSpec]:
    """Yield what shows how far rounding goes, where scenes differ by those beside them."""
    readers = _begun(first)[1]
    if readers and seen.differs(variant, "part") and not seen.differs(variant, "again"):
        arm = _faulted(seen, variant, readers, Scale(factor=1.0 + 4.0 * coarsest(first)))
        yield BlockSpec(arm, seen.scenes, "rounded")


def _begun(run: RecordedBlock) -> tuple[dict[tuple[str, str], Read], dict[str, list[str]]]:
    """Return the first read of each tap, and by channel who reads numbers with a fraction."""
    begins: dict[tuple[str, str], Read] = {}
    readers: dict[str, list[str]] = {}
    for read in run.reads:
        if read.clean and read.tap not in begins:
            begins[read.tap] = read
            if "float" in read.dtype:
                readers.setdefault(read.channel, []).append(read.consumer)
    return begins, readers


def _faulted(
    seen: Seen, variant: str, readers: Mapping[str, Sequence[str]], doing: AnyIntervention
) -> Arm:
    interface, present = seen.system.interface, seen.system.variants[variant].consumers
    faults = [
        part
        for channel, consumers in readers.items()
        for part in Fault(channel=channel, intervention=doing, consumers=tuple(consumers)).resolved(
            interface, present
        )
    ]
    return Arm(variant=variant, seed=seen.seed, faults=tuple(faults))
