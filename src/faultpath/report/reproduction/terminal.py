"""The ledger for the terminal, as rich renderables, and as Markdown."""

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from faultpath.record.claim import Answer, Ledger
from faultpath.record.table import Entry
from faultpath.record.table import Table as Figures
from faultpath.report import escapes, wording
from faultpath.report.reproduction import words

_STYLE: dict[Answer, str] = {"confirmed": "green", "refuted": "bold red", "undecided": "dim"}


def ledger_counts(ledger: Ledger) -> Text:
    """Return `24 confirmed, 6 refuted, 9 undecided`, each in its colour."""
    parts = (
        Text(f"{words.SIGNS[answer]} {ledger.count(answer)} {answer}", _STYLE[answer])
        for answer in words.ANSWERS
    )
    return Text(", ").join(parts)


def ledger_table(ledger: Ledger) -> Table:
    """Return one line a claim: what was claimed, what came of it, and by what estimate."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for head in ("claim", "verdict", "estimate", "detectable"):
        right = head in ("estimate", "detectable")
        table.add_column(head, no_wrap=True, justify="right" if right else "left")
    table.add_column("")  # the only column that may shrink
    for claim in ledger.claims:
        verdict = Text(f"{words.SIGNS[claim.verdict]} {claim.verdict}", _STYLE[claim.verdict])
        table.add_row(
            Text(claim.id),
            verdict,
            Text(words.estimate(claim) or "–"),
            Text(words.least_detectable(claim) or "–"),
            Text(words.typeset(claim.claim), no_wrap=True, overflow="ellipsis"),
        )
    return table


def ledger_view(ledger: Ledger) -> RenderableType:
    """Return headline, counts by kind and the claims."""
    title = Text(f"{words.headline(ledger)}.", style="bold")
    where = Text(
        f"{ledger.library}, {wording.counted(ledger.scenes, 'scene')}, "
        f"{wording.seeds(ledger.seeds)}"
    )
    note = (Text(ledger.note, "dim"),) if ledger.note else ()
    return Group(
        title, where, *note, Text(""), ledger_table(ledger), Text(""), ledger_counts(ledger)
    )


def ledger_markdown(ledger: Ledger) -> str:
    """Return the ledger as a Markdown table, the counts above it."""
    rows = [
        "| Claim | Kind | Verdict | Estimate | Detectable | The paper | What is claimed |",
        "| :-- | :-- | :-- | --: | --: | :-- | :-- |",
    ]
    for claim in ledger.claims:
        cells = (
            claim.id,
            claim.kind,
            f"{words.SIGNS[claim.verdict]} {claim.verdict}",
            words.estimate(claim) or "–",
            words.least_detectable(claim) or "–",
            words.typeset(claim.paper),
            words.typeset(claim.claim),
        )
        rows.append(f"| {' | '.join(escapes.markdown(cell) for cell in cells)} |")
    about = (
        f"{ledger.library}, {wording.counted(ledger.scenes, 'scene')}, "
        f"{wording.seeds(ledger.seeds)}."
    )
    if ledger.note:
        about = f"{about} {ledger.note}"
    return "\n".join([f"{words.headline(ledger)}.", "", escapes.markdown(about), "", *rows, ""])


def figures_view(table: Figures) -> RenderableType:
    """Return a table of figures for the terminal: ours, and below it the paper's in parentheses."""
    shown = Table(title=Text(table.title), title_justify="left", box=None, pad_edge=False)
    shown.add_column("")
    for column in table.columns:
        shown.add_column(Text(column), justify="right")
    for line in table.lines:
        if not line.entries:
            shown.add_row(Text(line.label, "italic"))
            continue
        shown.add_row(Text(line.label), *map(_figure, line.entries))
    return shown


def _figure(entry: Entry) -> Text:
    text = Text(entry.text, "bold" if entry.detected else "")
    return text.append(f"\n({entry.published})", "dim") if entry.published else text
