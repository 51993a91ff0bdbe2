"""The ledger claim by claim, for the terminal and as a Markdown table."""

from collections.abc import Iterable, Sequence

from rich.align import AlignMethod
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from faultpath.core.text import counted
from faultpath.report.escapes import markdown
from faultpath.report.sentences import wording
from faultpath.report.tables import MISSING, Entry, Table, Tone, line, markdown_grid
from faultpath.report.terminal import STYLES
from faultpath_paper.answers import Answer, ClaimVerdict, Ledger, Size
from faultpath_paper.cells import data
from faultpath_paper.report import words

_TONES: dict[Answer, Tone] = {"confirmed": "good", "refuted": "bad", "undecided": "faint"}
_SHOWN: dict[str, AlignMethod] = data("words.yaml")["shown"]
_PRINTED: Sequence[str] = data("words.yaml")["printed"]
_IN_SHORT: dict[Size, str] = {
    **words.BESIDE,
    "right sign, other size": "same direction",
    "not comparable": MISSING,
}
"""Words of the terminal, which has few columns."""


def ledger_view(ledger: Ledger, profile: str) -> RenderableType:
    """Return the headline, the claims with their verdicts and sentences, and counts.

    A quick run has neither counts nor sizes.
    """
    title = Text(f"{words.headline(ledger, profile)}.", style="bold")
    blank = Text("")
    below = (Text(words.sizes(ledger)),) if words.sizes(ledger) else ()
    about, claims = Text(_about(ledger)), _claims(ledger)
    if profile == words.QUICK:
        return Group(title, Text(words.VERDICTS), about, blank, *claims)
    return Group(title, about, blank, *claims, blank, title, *below)


def _claims(ledger: Ledger) -> Iterable[RenderableType]:
    rows = [[Text(claim.id), *_shown(claim)] for claim in ledger.claims]
    heads = [Text(head) for head in _SHOWN]
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]

    def aligned(cells: Sequence[Text]) -> Text:
        for cell, side, width in zip(cells, _SHOWN.values(), widths, strict=True):
            cell.align(side, width)
        return Text("  ").join(cells)

    yield aligned(heads)
    for claim, row in zip(ledger.claims, rows, strict=True):
        yield aligned(row)
        sentence = Text(words.typeset(claim.claim), "dim")
        yield Padding(sentence, (0, 0, 0, widths[0] + 2))


def _shown(claim: ClaimVerdict) -> Iterable[Text]:
    entries = _entries(claim)
    for column in list(_SHOWN)[1:]:
        entry = entries[column]
        yield Text(entry) if isinstance(entry, str) else Text(entry.text, STYLES[entry.tone])


def ledger_markdown(ledger: Ledger, profile: str) -> str:
    """Return the ledger as a Markdown table, the counts above it."""
    lines = (
        line(claim.id, *(entries[column] for column in _PRINTED))
        for claim in ledger.claims
        for entries in [_entries(claim)]
    )
    texts = ("Kind", "Result", "Beside the paper", "The paper", "What is claimed")
    table = markdown_grid(
        Table(corner="Claim", columns=tuple(_PRINTED), lines=tuple(lines), words=texts)
    )
    sizes = (
        [markdown(f"{words.sizes(ledger)} {data('words.yaml')['farthest']}")]
        if words.sizes(ledger)
        else []
    )
    head = f"{words.headline(ledger, profile)}.", markdown(f"{_about(ledger)}.")
    return "\n\n".join([*head, table, *sizes]) + "\n"


def _about(ledger: Ledger) -> str:
    scenes = counted(ledger.scenes, "scene")
    return f"{ledger.library}, {scenes}, {wording.seeds(ledger.seeds)}"


def _entries(claim: ClaimVerdict) -> dict[str, str | Entry]:
    answer = f"{words.SIGNS[claim.verdict]} {words.SHOWN[claim.verdict]}"
    return {
        "Kind": words.KIND[claim.kind],
        "Result": Entry(text=answer, tone=_TONES[claim.verdict]),
        "Estimate": words.estimate(claim) or MISSING,
        "Beside paper": _IN_SHORT[words.farthest(claim)],
        "Beside the paper": words.size(claim) or MISSING,
        "Detectable": words.least_detectable(claim) or MISSING,
        "The paper": words.typeset(claim.paper),
        "What is claimed": words.typeset(claim.claim),
    }
