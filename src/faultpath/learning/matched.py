"""Checks whether two fits differ only in the repair, and lists every other difference."""

from collections.abc import Iterator
from math import isclose
from pathlib import Path
from typing import TypeAlias

from faultpath.core.results import Frozen
from faultpath.core.text import listed
from faultpath.learning.fitting import Fit
from faultpath.learning.model_card import Data, FitRecord, read_card

_SAME_LOSS = 1e-4
"""Relative difference of first losses between machines; another computation differs by more."""

FitSource: TypeAlias = Fit | FitRecord | Path | str
"""A fit, its record, or the path of its weights."""


class Comparison(Frozen):
    """Differences between a baseline and its repair."""

    baseline: str
    """Its repair in words, `none` for a plain one."""
    repair: str
    same_repair: bool
    differences: tuple[str, ...]
    """Differences other than the repair, a sentence each."""

    @property
    def matched(self) -> bool:
        """Whether the repair is the only difference."""
        return not (self.differences or self.same_repair)

    def __str__(self) -> str:
        if self.differences:
            return "\n  - ".join(("not matched:", *self.differences))
        if self.same_repair:
            return f"the same fit twice: even the repair ({self.repair}) is the same"
        against = "" if self.baseline == "none" else f" against {self.baseline}"
        return f"matched in all but the repair ({self.repair}{against})"


def matched(baseline: FitSource, repair: FitSource) -> Comparison:
    """Compare two fits by their records: fits, records, or paths of weights files.

    `UserError` for a record that is missing or damaged.
    """
    one, other = (_record(fit) for fit in (baseline, repair))
    differences: list[str] = []

    def compare(what: str, mine: object, theirs: object) -> None:
        if mine != theirs:
            differences.append(f"{what} {mine} in the baseline and {theirs} in the repair.")

    def compare_fields(what: str, mine: Frozen, theirs: Frozen) -> None:
        after = theirs.model_dump()
        for name, value in mine.model_dump().items():
            compare(f"{what}: {name.replace('_', ' ')}", value, after[name])

    compare("Inputs:", listed(one.reads), listed(other.reads))
    seeds = f"seeds {one.seed} and {other.seed}."
    mine, theirs = one.architecture, other.architecture
    if mine.tensors != theirs.tensors:
        names = {**mine.tensors, **theirs.tensors}
        name = next(n for n in names if mine.tensors.get(n) != theirs.tensors.get(n))
        before, after = (side.tensors.get(name, "missing") for side in (mine, theirs))
        compare("Architecture:", f"'{name}' is {before}", after)
    else:  # initial weights can be compared only with the same tensors
        if mine.structure != theirs.structure:
            lines = zip(mine.structure.splitlines(), theirs.structure.splitlines(), strict=False)
            pairs = ((a.strip(), b.strip()) for a, b in lines if a != b)
            compare("Architecture:", *next(pairs, (mine.name, theirs.name)))
        if one.initial_sha256 != other.initial_sha256:
            differences.append(f"Initialisation: the weights before the first step differ; {seeds}")
    differences += _data_differences(one.data, other.data)
    compare("Loss:", one.loss, other.loss)
    compare_fields("Budget", one.schedule, other.schedule)
    if one.data.training_sha256 == other.data.training_sha256:
        epochs = enumerate(zip(one.order_sha256, other.order_sha256, strict=False), start=1)
        first = next((epoch for epoch, (a, b) in epochs if a != b), None)
        if first is not None:
            differences.append(f"Minibatch order: different from epoch {first} on; {seeds}")
    compare_fields("Machine", one.machine, other.machine)
    if not differences and not isclose(one.first_loss, other.first_loss, rel_tol=_SAME_LOSS):
        differences.append(
            "Computation: before any step the same weights have the loss "
            f"{one.first_loss:.6g} in the baseline and {other.first_loss:.6g} in the repair on "
            "the same correct inputs, so the code of module or loss differs."
        )
    return Comparison(
        baseline=one.repair,
        repair=other.repair,
        same_repair=one.repairs == other.repairs,
        differences=tuple(differences),
    )


def _record(fit: FitSource) -> FitRecord:
    if isinstance(fit, FitRecord):
        return fit
    return fit.record if isinstance(fit, Fit) else read_card(Path(fit), FitRecord)


def _data_differences(mine: Data, theirs: Data) -> Iterator[str]:
    if mine.ids_sha256 != theirs.ids_sha256:  # readings, split and order follow
        yield (
            f"Data: other windows, {mine.windows} in the baseline and {theirs.windows} in the "
            "repair."
        )
        return
    for what in ("readings", "targets"):
        before, after = (getattr(side, f"{what}_sha256") for side in (mine, theirs))
        names = sorted(n for n in {*before, *after} if before.get(n) != after.get(n))
        if names:
            yield f"Data: the {what} of {listed(names)} differ."
    if mine.dt_s != theirs.dt_s:
        yield f"Data: steps of {mine.dt_s:g} s in the baseline and {theirs.dt_s:g} s in the repair."
    if mine.training_sha256 != theirs.training_sha256:
        yield (
            f"Split: other windows are trained on, {mine.training} in the baseline and "
            f"{theirs.training} in the repair."
        )
