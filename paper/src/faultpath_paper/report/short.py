"""A ledger in short: verdicts by kind, sizes by subject, and claims not confirmed."""

from collections.abc import Iterator

from faultpath.report.tables import Entry, Line, Table, line
from faultpath_paper.answers import ClaimVerdict, Ledger, StatementPart
from faultpath_paper.claims import SUBJECTS
from faultpath_paper.report.words import (
    ANSWERS,
    BESIDE,
    KINDS,
    SHOWN,
    SIZES,
    estimate,
    figure,
    is_non_detection,
    typeset,
)


def by_kind(ledger: Ledger) -> Table:
    """Return how many claims of each kind got which answer, with their ids.

    An asterisk marks what is confirmed by a difference that is not significant.
    """
    lines: list[Line] = []
    for kind, name in KINDS.items():
        claims = [claim for claim in ledger.claims if claim.kind == kind]
        lines.append(line(name, *(_ids(claims, answer) for answer in ANSWERS)))
    heads = tuple(SHOWN[answer] for answer in ANSWERS)
    return Table(corner="The paper's", columns=heads, words=heads, lines=tuple(lines))


def _ids(claims: list[ClaimVerdict], answer: str) -> str:
    ids = [f"{c.id}{'*' * is_non_detection(c)}" for c in claims if c.verdict == answer]
    return f"{len(ids)}: {', '.join(ids)}" if ids else "0"


def by_subject(ledger: Ledger) -> Table:
    """Return how the figures that the paper prints compare with ours, subject by subject."""
    lines = [
        line(subject, *_sizes([claim for claim in ledger.claims if claim.id in claims]))
        for subject, claims in SUBJECTS.items()
    ]
    lines.append(line("All", *_sizes(list(ledger.claims))))
    columns = ("figures", *(BESIDE[size] for size in SIZES))
    return Table(corner="Figures of", columns=columns, lines=tuple(lines))


def _sizes(claims: list[ClaimVerdict]) -> Iterator[Entry]:
    parts = [part for claim in claims for part in claim.parts if part.paper is not None]
    sizes = [part.size for part in parts]
    yield Entry(text=str(len(parts)))
    yield from (Entry(text=str(sizes.count(size))) for size in SIZES)


def apart(ledger: Ledger) -> Iterator[tuple[str, str]]:
    """Yield id and verdict of each claim that is not confirmed, with the part that decides."""
    for claim in ledger.claims:
        if claim.verdict != "confirmed":
            part = next(part for part in claim.parts if part.answer == claim.verdict)
            yield f"{claim.id}, {SHOWN[claim.verdict]}", _decisive(part)


def _decisive(part: StatementPart) -> str:
    statement = typeset(part.words.removesuffix(", by the point estimate"))
    paper = figure(part.model_copy(update={"estimate": part.paper})) if part.unit else ""
    shown = f"{statement}: {estimate(part) or 'no estimate'}"
    return "; ".join(filter(None, (shown, paper and f"the paper {paper}", part.reason)))
