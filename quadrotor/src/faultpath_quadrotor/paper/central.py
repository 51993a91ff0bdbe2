"""The paper's central claim: sharing the error reverses the ranking of GRU and GRU+DCC.

What was decided of it besides in a run itself stands in a file that comes with the package.
"""

from collections.abc import Iterable
from pathlib import Path

from faultpath.decisions import wording
from faultpath.decisions.tables import Entry, Line, Table, line
from faultpath_quadrotor.paper.answers import Ledger, Reproduction
from faultpath_quadrotor.paper.entries import bracket
from faultpath_quadrotor.paper.pages.table_4 import NAMES, PAGE, paper_contrast
from faultpath_quadrotor.paper.report import words

CLAIM = "C26"
BASELINE, REPAIR = "gru", "gru+dcc"
ELSEWHERE = Path(__file__).parent / "paper" / "reversal.json"
COLUMNS = ("Reconstruction only", "Shared error", "Reversal")
DECIDED, OPEN = "decided", "not decided"


def of_run(found: Reproduction, place: str) -> Line | None:
    """Return what a run of the paper found, by the paper's rules; `None` of one without it."""
    claim = next((each for each in found.ledger.claims if each.id == CLAIM), None)
    table = next((each for each in found.tables if each.name == PAGE.name), None)
    if claim is None or table is None:
        return None
    labels = [each.label for each in table.lines]
    at = labels.index(f"{NAMES[REPAIR]} minus {NAMES[BASELINE]}, success (pp)")
    differences, intervals = table.lines[at + 1].entries, table.lines[at + 2].entries
    shown = (
        Entry(text=f"{each.text} {ends.text}", detected=each.detected)
        for each, ends in zip(differences[1:], intervals[1:], strict=True)
    )
    return line(place, *shown, DECIDED if claim.parts[0].answer == "confirmed" else OPEN)


def state(ledger: Ledger, run: str = "this run") -> str:
    """Say what became of the claim in a run that is about it, and by which of its parts."""
    claim = next(each for each in ledger.claims if each.id == CLAIM)
    part = next(each for each in claim.parts if each.answer == claim.verdict)
    by = "" if claim.verdict == "confirmed" else f" by this part: {part.words}"
    figure = f" ({words.estimate(part)})" if words.estimate(part) else ""
    return f"As stated, {CLAIM} is {claim.verdict} on {run}{by}{figure}."


def central(lines: Iterable[Line]) -> Table:
    """Return the claim with its numbers and where it holds, the paper's below."""
    every = tuple(lines)
    held = [each.label for each in every if each.entries[-1].text == DECIDED]
    where = "; ".join(f"{place[:1].lower()}{place[1:]}" for place in held)
    theirs = [paper_contrast(REPAIR, BASELINE, path) for path in ("reconstruction-only", "shared")]
    printed = (f"{wording.signed(each.value)} {bracket(each.interval or ())}" for each in theirs)
    return Table(
        name="central",
        title="GRU+DCC minus GRU, success (pp), wind L3",
        columns=COLUMNS,
        lines=(*every, line("The paper", *printed, "claimed")),
        words=COLUMNS[-1:],
        notes=(
            f"The ranking reverses {where}." if held else "Nowhere is it decided.",
            "Each was decided by itself; no test compares them. Intervals of the paper and of its "
            "reproduction are percentile bootstraps of scenes, those of audits score intervals.",
        ),
    )


def of_page(found: Reproduction) -> tuple[str, Table] | None:
    """Return what the page of a run says first: the claim's state, and where it holds.

    `None` for a run that is not about the claim; of a quick run only what was decided besides.
    """
    asked = found.ledger
    if all(each.id != CLAIM for each in asked.claims):
        return None
    besides = Table.model_validate_json(ELSEWHERE.read_bytes()).lines
    if found.profile == words.QUICK:
        return f"A quick run decides nothing about {CLAIM}.", central(besides)
    seeds = wording.seeds(asked.seeds)
    own = of_run(found, f"In this run, {asked.scenes} scenes of {asked.library}, {seeds}")
    return state(asked), central([*([own] if own else []), *besides])
