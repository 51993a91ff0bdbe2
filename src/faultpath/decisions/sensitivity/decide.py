"""From the values of a design to the record, and what is said of it."""

from collections.abc import Iterator, Sequence

import numpy as np

from faultpath.decisions.sensitivity.model import (
    Index,
    Indices,
    ResolvedSensitivity,
    SensitivityRecord,
)
from faultpath.decisions.sentences.wording import capital, counted, plain, series
from faultpath.statistics.estimate import ALPHA
from faultpath.statistics.inputs import Floats
from faultpath.statistics.sobol import indices


def conclude(
    question: ResolvedSensitivity,
    values: Floats,
    scenes: int,
    failed: int = 0,
    findings: Sequence[str] = (),
) -> SensitivityRecord:
    """Return the record of `values` `[rows of the design]`, a mean over `scenes` each."""
    names = [group.name for group in question.groups]
    level = 1.0 - ALPHA / (2 * len(names))  # two indices a group
    estimates = indices(values, len(names), level, question.design_seed)
    every: tuple[Indices, ...] = ()
    if estimates is not None:
        firsts = zip(estimates.first.tolist(), estimates.first_width.tolist(), strict=True)
        totals = zip(estimates.total.tolist(), estimates.total_width.tolist(), strict=True)
        every = tuple(
            Indices(group=name, first=_index(*first), total=_index(*total))
            for name, first, total in zip(names, firsts, totals, strict=True)
        )
    record = SensitivityRecord(
        question=question,
        values=tuple(values.tolist()),
        scenes=scenes,
        indices=every,
        level=level,
        failed=failed,
        findings=tuple(findings),
    )
    texts = {"headline": headline(record), "sentences": tuple(sentences(record))}
    return record.model_copy(update=texts)


def _index(value: float, width: float) -> Index:
    return Index(value=value, low=value - width, high=value + width)


def foremost(record: SensitivityRecord) -> str:
    """Return the group whose first-order index is decided to be the largest; empty for none."""
    for index in record.indices:
        others = [other.first.high for other in record.indices if other is not index]
        if index.first.counts and index.first.low > max(others):
            return index.group
    return ""


def headline(record: SensitivityRecord) -> str:
    """Return which source explains most, as far as that is decided in the scenes that were run."""
    question = record.question
    if not record.indices:
        return (
            f"{capital(question.said)} hardly varies with these errors: there is nothing to "
            "explain."
        )
    if first := foremost(record):
        where = counted(record.scenes, "scene")
        return f"Alone, {first} explains more than any other source in the {where} that ran."
    alone = [index.group for index in record.indices if index.first.counts]
    if len(alone) == 1:
        return f"{alone[0]} explains a share by itself; whether it is the largest is open."
    if alone:
        return f"{series(alone)} each explain a share; which explains most is open."
    if matter := [index.group for index in record.indices if index.total.counts]:
        return f"{series(matter)} matter, but no share of one alone is significant."
    return "Nothing is significant: of no source is it shown that its error matters."


def sentences(record: SensitivityRecord) -> Iterator[str]:
    """Say which indices leave out zero, whose order is decided, and what is taken for granted."""
    question = record.question
    for index in record.indices:
        clauses: list[str] = []
        if index.first.counts:
            clauses.append(f"alone it explains {_percent(index.first)} of the variance")
        if index.total.counts:
            clauses.append(f"with all that it does together with others {_percent(index.total)}")
        if index.total.counts and index.total.low > index.first.high:
            clauses.append("part of it acts only together with others")
        if clauses:
            yield f"{index.group}: {'; '.join(clauses)}."
    for kind, phrase in (("first", "alone"), ("total", "with others")):
        ordered = [
            f"{one.group} more than {other.group}"
            for one in record.indices
            for other in record.indices
            if getattr(one, kind).counts and getattr(one, kind).low > getattr(other, kind).high
        ]
        if ordered:
            yield f"Significant differences in what they explain {phrase}: {series(ordered)}."
    if record.indices and (open_ := [e.group for e in record.indices if not e.total.counts]):
        yield f"Of {series(open_)} nothing is shown; that is no proof that it does not matter."
    drawn = np.array(record.values).reshape(-1, len(question.groups) + 2)[:, [0, -1]]
    yield (
        f"Under these errors {question.said} is {plain(float(drawn.mean()), 2)} {question.unit} on "
        f"average, with a standard deviation of {plain(float(drawn.std()), 2)}."
    )
    yield (
        "Errors of different groups are taken to be independent; sources of one correlation group "
        "err together, by one cause. What groups have in common is not modelled."
    )
    yield (
        f"All of it holds for the {counted(record.scenes, 'scene')} that were run and for errors "
        f"as large as declared; the {2 * len(question.groups)} intervals hold at once in about "
        f"{100 * (1 - ALPHA):g} % of such designs."
    )
    if question.left_out:
        yield f"No error is declared of {series(question.left_out)}: read without error throughout."


def _percent(index: Index) -> str:
    ends = f"[{plain(100 * index.low, 0)}, {plain(100 * index.high, 0)}]"
    return f"{plain(100 * index.value, 0)} % {ends}"
