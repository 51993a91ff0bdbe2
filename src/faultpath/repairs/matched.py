"""Whether two fits differ in the repair alone: every other difference, in a sentence."""

from collections.abc import Iterator, Mapping
from math import isclose
from pathlib import Path
from typing import TypeAlias

from faultpath.frozen import Frozen
from faultpath.repairs.fitting import Fit
from faultpath.repairs.record import FitRecord, read_record
from faultpath.text import listed

_SAME_LOSS = 1e-4
"""Relative difference of a first loss that machines may cause and another computation does not."""


Recorded: TypeAlias = Fit | FitRecord | Path | str
"""A fit, its record, or the path of its weights."""


class Comparison(Frozen):
    """What tells a baseline and its repair apart."""

    baseline: str
    """Its repair in words, `none` for a plain one."""
    repair: str
    same_repair: bool
    differences: tuple[str, ...]
    """Beside the repair, a sentence each."""

    @property
    def matched(self) -> bool:
        """Whether the repair is the only difference."""
        return not (self.differences or self.same_repair)

    def __str__(self) -> str:
        if self.differences:
            return "\n".join(("not matched:", *(f"  - {each}" for each in self.differences)))
        if self.same_repair:
            return (
                f"the same fit twice: nothing tells them apart, the repair ({self.repair}) neither"
            )
        against = "" if self.baseline == "none" else f" against {self.baseline}"
        return f"matched in all but the repair ({self.repair}{against})"


def matched(baseline: Recorded, repair: Recorded) -> Comparison:
    """Compare two fits by their records: fits, records, or paths of weights files.

    `UserError` for a record that is missing or damaged.
    """
    one, other = _record(baseline), _record(repair)
    found = [*_inputs(one, other), *_architecture(one, other), *_data(one, other)]
    found += [*_loss(one, other), *_budget(one, other), *_start(one, other), *_order(one, other)]
    found += _machine(one, other)
    if not found and not isclose(one.initial_loss, other.initial_loss, rel_tol=_SAME_LOSS):
        found.append(
            "Computation: before any step the same weights have the loss "
            f"{one.initial_loss:.6g} in the baseline and {other.initial_loss:.6g} in the repair on "
            "the same correct inputs, so module or loss differ in code that the records cannot see."
        )
    return Comparison(
        baseline=one.repair,
        repair=other.repair,
        same_repair=one.repairs == other.repairs,
        differences=tuple(found),
    )


def _record(fit: Recorded) -> FitRecord:
    if isinstance(fit, FitRecord):
        return fit
    return fit.record if isinstance(fit, Fit) else read_record(Path(fit))


def _inputs(one: FitRecord, other: FitRecord) -> Iterator[str]:
    if one.reads != other.reads:
        yield (
            f"Inputs: the baseline is delivered {listed(one.reads)}; the repair is delivered "
            f"{listed(other.reads)}."
        )


def _architecture(one: FitRecord, other: FitRecord) -> Iterator[str]:
    mine, theirs = one.architecture, other.architecture
    if mine.tensors != theirs.tensors:
        name = _first_different(mine.tensors, theirs.tensors)
        yield (
            f"Architecture: '{name}' is {mine.tensors.get(name, 'missing')} in the baseline and "
            f"{theirs.tensors.get(name, 'missing')} in the repair."
        )
    elif mine.structure != theirs.structure:
        lines = zip(mine.structure.splitlines(), theirs.structure.splitlines(), strict=False)
        shown = next(((a.strip(), b.strip()) for a, b in lines if a != b), (mine.name, theirs.name))
        yield f"Architecture: {shown[0]} in the baseline and {shown[1]} in the repair."
    elif mine.code_sha256 != theirs.code_sha256 and _comparable(one, other):
        yield f"Architecture: the code of {mine.name} differs, though its parts do not."


def _data(one: FitRecord, other: FitRecord) -> Iterator[str]:
    mine, theirs = one.data, other.data
    if mine.ids_sha256 != theirs.ids_sha256:
        yield (
            f"Data: other windows, {mine.windows} for the baseline and {theirs.windows} for the "
            "repair; readings, split and order follow."
        )
        return
    for what in ("readings", "targets"):
        before: dict[str, str] = getattr(mine, f"{what}_sha256")
        after: dict[str, str] = getattr(theirs, f"{what}_sha256")
        names = sorted(n for n in {*before, *after} if before.get(n) != after.get(n))
        if names:
            yield f"Data: the {what} of {listed(names)} differ."
    if mine.steps != theirs.steps:
        yield f"Data: windows of {mine.steps} steps in the baseline, {theirs.steps} in the repair."
    if mine.dt_s != theirs.dt_s:
        yield f"Data: steps of {mine.dt_s:g} s in the baseline and {theirs.dt_s:g} s in the repair."
    if mine.training_sha256 != theirs.training_sha256:
        yield (
            f"Split: other windows are trained on, {mine.training} in the baseline and "
            f"{theirs.training} in the repair; their order follows."
        )


def _loss(one: FitRecord, other: FitRecord) -> Iterator[str]:
    if one.loss.name != other.loss.name:
        yield f"Loss: {one.loss.name} in the baseline and {other.loss.name} in the repair."
    elif one.loss != other.loss and _comparable(one, other):
        yield f"Loss: both are called {one.loss.name}, and their code or constants differ."


def _budget(one: FitRecord, other: FitRecord) -> Iterator[str]:
    before, after = one.schedule.model_dump(), other.schedule.model_dump()
    for name, value in before.items():
        if value != after[name]:
            yield (
                f"Budget: {name.replace('_', ' ')} {value} in the baseline and {after[name]} in "
                "the repair."
            )


def _start(one: FitRecord, other: FitRecord) -> Iterator[str]:
    same_tensors = one.architecture.tensors == other.architecture.tensors
    if same_tensors and one.initial_sha256 != other.initial_sha256:
        yield (
            "Initialisation: the weights before the first step differ; seeds "
            f"{one.seed} and {other.seed}."
        )


def _order(one: FitRecord, other: FitRecord) -> Iterator[str]:
    if one.data.training_sha256 != other.data.training_sha256:
        return
    epochs = enumerate(zip(one.order_sha256, other.order_sha256, strict=False), start=1)
    first = next((epoch for epoch, (a, b) in epochs if a != b), None)
    if first is not None:
        yield (
            f"Minibatch order: other windows come first from epoch {first} on; seeds "
            f"{one.seed} and {other.seed}."
        )


def _machine(one: FitRecord, other: FitRecord) -> Iterator[str]:
    before, after = one.machine.model_dump(), other.machine.model_dump()
    for name, value in before.items():
        if value != after[name]:
            unsure = "; code was not compared" if name == "python" else ""
            found = f"{name} {value} in the baseline and {after[name]} in the repair"
            yield f"Machine: {found}{unsure}."


def _comparable(one: FitRecord, other: FitRecord) -> bool:
    return one.machine.python == other.machine.python


def _first_different(mine: Mapping[str, str], theirs: Mapping[str, str]) -> str:
    return next(name for name in {**mine, **theirs} if mine.get(name) != theirs.get(name))
