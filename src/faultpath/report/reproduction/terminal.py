"""The ledger as a table, for the terminal and as Markdown."""

from rich.console import Group, RenderableType
from rich.text import Text

from faultpath.record.reproduction import Answer, ClaimVerdict, Ledger
from faultpath.report import wording
from faultpath.report.reproduction import words
from faultpath.tables import MISSING, Entry, Table, line
from faultpath.tables.escapes import markdown
from faultpath.tables.markdown import grid
from faultpath.tables.model import Tone
from faultpath.tables.terminal import STYLES, drawn

_TONES: dict[Answer, Tone] = {"confirmed": "good", "refuted": "bad", "undecided": "faint"}
_COLUMNS = ("Verdict", "Estimate", "Detectable", "What is claimed")
_PRINTED = ("Kind", *_COLUMNS[:3], "The paper", "What is claimed")


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
    texts = ("Kind", "Verdict", "The paper", "What is claimed")
    return Table(corner="Claim", columns=columns, lines=tuple(lines), words=texts)


def ledger_view(ledger: Ledger) -> RenderableType:
    """Return headline, counts by kind and the claims."""
    title = Text(f"{words.headline(ledger)}.", style="bold")
    note = (Text(ledger.note, "dim"),) if ledger.note else ()
    table = drawn(_table(ledger), one_line=True)
    blank = Text("")
    return Group(title, Text(_about(ledger)), *note, blank, table, blank, _counts(ledger))


def ledger_markdown(ledger: Ledger) -> str:
    """Return the ledger as a Markdown table, the counts above it."""
    about = f"{_about(ledger)}. {ledger.note}".rstrip()
    table = grid(_table(ledger, _PRINTED))
    return "\n".join([f"{words.headline(ledger)}.", "", markdown(about), "", table, ""])


def _about(ledger: Ledger) -> str:
    scenes = wording.counted(ledger.scenes, "scene")
    return f"{ledger.library}, {scenes}, {wording.seeds(ledger.seeds)}"


def _entries(claim: ClaimVerdict) -> dict[str, str | Entry]:
    verdict = f"{words.SIGNS[claim.verdict]} {claim.verdict}"
    return {
        "Kind": claim.kind,
        "Verdict": Entry(text=verdict, tone=_TONES[claim.verdict]),
        "Estimate": words.estimate(claim) or MISSING,
        "Detectable": words.least_detectable(claim) or MISSING,
        "The paper": words.typeset(claim.paper),
        "What is claimed": words.typeset(claim.claim),
    }
