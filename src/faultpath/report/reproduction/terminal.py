"""The ledger as a table, for the terminal and as Markdown."""

from rich.console import Group, RenderableType
from rich.text import Text

from faultpath.record.reproduction import Answer, ClaimVerdict, Ledger, Size
from faultpath.report import wording
from faultpath.report.reproduction import words
from faultpath.tables import MISSING, Entry, Table, line
from faultpath.tables.escapes import markdown
from faultpath.tables.markdown import grid
from faultpath.tables.model import Tone
from faultpath.tables.terminal import STYLES, drawn

_TONES: dict[Answer, Tone] = {"confirmed": "good", "refuted": "bad", "undecided": "faint"}
_COLUMNS = ("Verdict", "Estimate", "Size", "Detectable", "What is claimed")
_PRINTED = ("Kind", "Verdict", "Estimate", "Sizes", "Detectable", "The paper", "What is claimed")
_IN_SHORT: dict[Size, str] = {
    "right sign, other size": "right sign only",
    "not comparable": MISSING,
}


_FARTHEST = (
    "Sizes: how the estimate stands to the paper's figure, for the statement of a claim that is "
    "farthest from it, and how many of those that can be compared stand so. No verdict depends on "
    "it."
)


def _counts(ledger: Ledger) -> Text:
    """Return `24 confirmed, 6 refuted, 9 undecided`, each in its colour."""
    parts = (
        Text(f"{words.SIGNS[answer]} {ledger.count(answer)} {answer}", STYLES[_TONES[answer]])
        for answer in words.ANSWERS
    )
    return Text(", ").join(parts)


def _table(ledger: Ledger, columns: tuple[str, ...] = _COLUMNS) -> Table:
    """Return one line a claim: what was claimed, what came of it, and by what estimate."""
    lines = (
        line(claim.id, *(entries[column] for column in columns))
        for claim in ledger.claims
        for entries in [_entries(claim)]
    )
    texts = ("Kind", "Verdict", "Size", "Sizes", "The paper", "What is claimed")
    return Table(corner="Claim", columns=columns, lines=tuple(lines), words=texts)


def ledger_view(ledger: Ledger) -> RenderableType:
    """Return headline, counts by kind and the claims."""
    title = Text(f"{words.headline(ledger)}.", style="bold")
    note = tuple(Text(each, "dim") for each in words.notes(ledger))
    table = drawn(_table(ledger), one_line=True)
    blank = Text("")
    below = (Text(words.sizes(ledger)),) if words.sizes(ledger) else ()
    return Group(title, Text(_about(ledger)), *note, blank, table, blank, _counts(ledger), *below)


def ledger_markdown(ledger: Ledger) -> str:
    """Return the ledger as a Markdown table, the counts above it."""
    about = " ".join([f"{_about(ledger)}.", *words.notes(ledger)])
    table = grid(_table(ledger, _PRINTED))
    sizes = ["", markdown(f"{words.sizes(ledger)} {_FARTHEST}")] if words.sizes(ledger) else []
    return "\n".join([f"{words.headline(ledger)}.", "", markdown(about), "", table, *sizes, ""])


def _about(ledger: Ledger) -> str:
    scenes = wording.counted(ledger.scenes, "scene")
    return f"{ledger.library}, platform {ledger.platform}, {scenes}, {wording.seeds(ledger.seeds)}"


def _entries(claim: ClaimVerdict) -> dict[str, str | Entry]:
    verdict = f"{words.SIGNS[claim.verdict]} {claim.verdict}"
    size, _, _ = words.farthest(claim)
    return {
        "Kind": claim.kind,
        "Verdict": Entry(text=verdict, tone=_TONES[claim.verdict]),
        "Estimate": words.estimate(claim) or MISSING,
        "Size": _IN_SHORT.get(size, size),
        "Sizes": words.size(claim) or MISSING,
        "Detectable": words.least_detectable(claim) or MISSING,
        "The paper": words.typeset(claim.paper),
        "What is claimed": words.typeset(claim.claim),
    }
