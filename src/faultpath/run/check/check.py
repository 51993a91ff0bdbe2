"""Run a system as a careful reviewer would, and judge what was seen."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from hashlib import sha256
from itertools import pairwise
from typing import Generic, Literal, TypeVar

from faultpath.core.errors import UserError
from faultpath.core.results import Result
from faultpath.core.text import unknown
from faultpath.faults import AnyIntervention, Erase, Fault, Offset, Scale, resolve
from faultpath.faults import Sequence as InTurn
from faultpath.run.check.blocks import (
    UNDER,
    BlockSpec,
    CheckRuns,
    RecordedBlock,
    coarsest,
    run_blocks,
)
from faultpath.run.check.delivery import HELD, MOVED, reader_at, unanswered
from faultpath.run.check.judging import judged
from faultpath.run.check.reads import Read
from faultpath.run.check.results import Checked
from faultpath.run.execution.dispatch import Built
from faultpath.run.plan import SystemSpec, Treatment
from faultpath.run.question import CheckQuestion
from faultpath.run.work.processes import local
from faultpath.system.checks import library_of
from faultpath.system.declared import Variant
from faultpath.system.system import System

MOST = 4
"""A system of up to so many variants is checked whole, unless some are named; of a larger one the
first two, or one for each part of the user's own: a system lists those that run with them first."""
_AFTER = 20
"""Control steps for which a tap is faulted."""

_Told = TypeVar("_Told")


class SystemCheck(Result, Generic[_Told]):
    """A check of a system, whose parts are data or words."""

    format: Literal[2] = 2
    system: str
    options: dict[str, str]
    variants: tuple[str, ...]
    library: str
    scenes: tuple[str, ...]
    of: int
    """Number of scenes of the library."""
    seed: int
    fault: str | None = None
    checks: tuple[_Told, ...]


def run_checks(
    system: System,
    spec: SystemSpec,
    question: CheckQuestion,
    note: Callable[[int, int | None], None],
    conditions: Mapping[str, Mapping[str, Sequence[Fault]]],
) -> SystemCheck[Checked]:
    """Check a system: what it promises, what it reads, and that faults reach it.

    `note` is called with the runs done, and of how many once that is known. `conditions` are those
    of the question's fault: by name, and then by variant, what acts. Raises `UserError` for a
    variant, library or number of scenes that there is not, and where the system cannot be built in
    a worker process.
    """
    library = library_of(system, question.library)
    if not 1 <= question.scenes <= len(library.scenes):
        raise UserError(
            f"cannot check {question.scenes} scenes of library '{library.name}': choose 1 to "
            f"{len(library.scenes)}."
        )
    ids = [scene.id for scene in library.scenes]
    edges = [part * len(ids) // question.scenes for part in range(question.scenes + 1)]
    # By their hash: whoever checks the library takes the same ones, and not the first of each part.
    scenes = tuple(
        min(ids[start:end], key=lambda scene: sha256(scene.encode()).digest())
        for start, end in pairwise(edges)
    )
    variants = chosen_variants(system, question.variants)
    workers = (2 if system.parallel else 1) if question.workers is None else question.workers
    runs = CheckRuns(system, variants, scenes, question.seed, workers > 0)
    built = Built.of(system, spec, library.name)

    def run(blocks: Sequence[BlockSpec], workers: int = workers) -> None:
        known = len(runs.recorded) + len(blocks) if runs.recorded else None

        def handle_reply(block: BlockSpec, result: RecordedBlock) -> None:
            runs.recorded[block.treatment.variant, block.why, block.tap] = result
            note(len(runs.recorded), known)

        with local(workers) as executor:  # new processes: they share nothing with those before
            run_blocks(executor, built, blocks, handle_reply)

    run([BlockSpec(_treatment(runs, variant.name, {}), scenes, "first") for variant in variants])
    again = [block for name, first in runs.firsts() for block in _again(runs, name, first)]
    for where, faults in conditions.items():
        for name in (name for name, _ in runs.firsts() if faults[name]):
            treatment = Treatment(variant=name, faults=tuple(faults[name]), seed=runs.seed)
            again.append(BlockSpec(treatment, scenes, f"{UNDER}{where}"))
    run(again)
    if doubts := list(_doubts(runs)):
        run(doubts)
    for name in runs.unsteady() if runs.apart else ():
        for whys in (("alone",), ("anew", "repeated")):
            run([BlockSpec(_treatment(runs, name, {}), scenes, why) for why in whys], workers=1)
    return SystemCheck[Checked](
        system=spec.name,
        options=spec.options,
        variants=tuple(variant.name for variant in variants),
        library=library.name,
        scenes=scenes,
        of=len(ids),
        seed=question.seed,
        fault=question.fault and str(question.fault),
        checks=judged(runs),
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


def _again(runs: CheckRuns, variant: str, first: RecordedBlock) -> Iterator[BlockSpec]:
    """Yield what is run of a variant beside its first run."""
    yield BlockSpec(_treatment(runs, variant, {}), runs.scenes, "again", second=runs.apart)
    if len(runs.scenes) > 1:
        yield BlockSpec(_treatment(runs, variant, {}), runs.scenes[::-2], "part")
    floats = _floats(first)
    for channel, _ in Counter(channel for channel, _ in floats).most_common(1):
        nudged = {tap: Scale(factor=1.05) for tap in floats if tap[0] == channel}
        yield BlockSpec(_treatment(runs, variant, nudged), runs.scenes, "faulted")
    for tap, read in _begun(first).items():
        alone = _treatment(runs, variant, {tap: _altering(read)})
        yield BlockSpec(alone, runs.scenes, "tap", read.step + _AFTER, tap)


def _doubts(runs: CheckRuns) -> Iterator[BlockSpec]:
    """Yield what settles doubts: how far rounding goes, where scenes differ by those beside them;
    and whether a reader that answers no fault has its values from elsewhere. It is handed
    constants, first alone, and then while all that others read is faulted."""
    for variant, first in runs.firsts():
        floats = _floats(first)
        if floats and runs.difference(variant, "part") and not runs.difference(variant, "again"):
            nudged = dict.fromkeys(floats, Scale(factor=1.0 + 4.0 * coarsest(first)))
            yield BlockSpec(_treatment(runs, variant, nudged), runs.scenes, "rounded")
    silent = ((name, *reader_at(runs, name, tap)) for name, tap in unanswered(runs))
    for variant, taps, writes in dict.fromkeys(silent) if not runs.unsteady() else ():
        begun = _begun(runs.get(variant, "first"))
        constants = {tap: Erase(default=read.low) for tap, read in begun.items() if tap in taps}
        moved = {tap: _altering(read) for tap, read in begun.items()} | constants
        for why, doing in ((HELD, constants), (MOVED, moved)) if writes else ():
            yield BlockSpec(_treatment(runs, variant, doing), runs.scenes, why, tap=min(taps))


def _begun(run: RecordedBlock) -> dict[tuple[str, str], Read]:
    """Return the first read of each tap."""
    begun: dict[tuple[str, str], Read] = {}
    for read in (read for read in run.reads if read.clean):
        begun.setdefault(read.tap, read)
    return begun


def _floats(run: RecordedBlock) -> list[tuple[str, str]]:
    """Return the taps at which numbers with a fraction are read."""
    return [tap for tap, read in _begun(run).items() if "float" in read.dtype]


def _altering(read: Read) -> AnyIntervention:
    """Return what alters a reading, whatever it holds."""
    if "float" in read.dtype:
        return InTurn(parts=(Scale(factor=1.5), Offset(by=0.25)))
    # Whole numbers and truths stay what they are.
    return Erase(default=1.0 - read.low if read.dtype == "bool" else read.high + 1.0)


def _treatment(
    runs: CheckRuns, variant: str, doing: Mapping[tuple[str, str], AnyIntervention]
) -> Treatment:
    """Return the treatment of a variant in which something is done at some taps."""
    faults = (
        Fault(channel=channel, intervention=what, readers=(reader,))
        for (channel, reader), what in doing.items()
    )
    present = runs.system.variants[variant].readers
    resolved = resolve(faults, runs.system.interface, present)
    return Treatment(variant=variant, faults=resolved, seed=runs.seed)
