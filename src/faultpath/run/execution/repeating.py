"""Whether the code that is here repeats a finished run that other code made: some of its blocks."""

import hashlib
from collections.abc import Callable, Mapping, Sequence

from faultpath.core.errors import UserError
from faultpath.run.attempt import Done, Reply, Wrong
from faultpath.run.execution.recheck import deviation
from faultpath.run.execution.schedule import Task, Unit
from faultpath.run.store.folder import RunFolder

_OF_EACH = 4
"""Blocks of each variant that are repeated, under different conditions."""


def repeat(
    blocks: Mapping[str, Done],
    units: Sequence[Unit],
    folder: RunFolder,
    work: Callable[[Callable[[int], Task | None], Callable[[Task, Reply], None]], None],
    changed: str,
) -> str:
    """Run a sample of the blocks of a finished run again and say how many trials they hold.

    The sample is always the same of the same run; `changed` is what changed since. `UserError`
    with the first block that differs.
    """
    tasks = [Task(unit, unit.scenes, recheck="sample") for unit in _sample(units)]
    waiting = iter(tasks)

    def handle_reply(task: Task, reply: Reply) -> None:
        if isinstance(reply, Wrong):
            raise reply.error
        treatment = task.unit.treatment
        if differs := deviation(blocks[task.unit.key].outcomes, reply):
            faults = (
                " and ".join(fault.describe() for fault in treatment.faults) or "correct inputs"
            )
            where = f"{faults}, seed {treatment.seed}, {len(task.scenes)} scenes from "
            where += repr(task.scenes[0])
            raise UserError(
                f"{folder.path} holds a finished run, and what is here does not repeat it (changed "
                f"since: {changed}): a block of {treatment.variant!r} ({where}) {differs}. "
                "Nothing in the folder was changed: choose a new one."
            )

    work(lambda worker: next(waiting, None), handle_reply)
    count = sum(len(task.scenes) for task in tasks)
    return (
        f"{folder.path} was finished before {changed} changed. {count} of its trials ran again and "
        "are equal to the bit, so the run counts as it is."
    )


def _sample(units: Sequence[Unit]) -> list[Unit]:
    """Return a few units of each variant, under as many conditions as that gives."""
    sample: list[Unit] = []
    by_lot = sorted(units, key=lambda unit: hashlib.sha256(unit.key.encode()).digest())
    for variant in sorted({unit.treatment.variant for unit in units}):
        of_variant = (unit for unit in by_lot if unit.treatment.variant == variant)
        conditions = {repr(unit.treatment.faults): unit for unit in of_variant}
        sample += list(conditions.values())[:_OF_EACH]
    return sample
