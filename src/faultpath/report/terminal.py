"""What the command line prints of a decision record, as rich renderables."""

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from faultpath.record.model import DecisionRecord
from faultpath.report.tables import DIFFERENCE, by_path, by_quantity
from faultpath.tables.terminal import drawn

_EFFECTS = (*DIFFERENCE, "holm", "scenes", "void", "break-even")


def decision(record: DecisionRecord) -> RenderableType:
    """Return the decision record as text and tables: verdict, effects, what would change it."""
    asked = record.question
    names = _EFFECTS if any(effect.void_pairs for effect in record.effects) else _WITHOUT_VOID
    success = by_quantity(record, ("baseline", "repair"))
    effects = by_path(record, names, f"{asked.repair} minus {asked.baseline}")
    parts: list[RenderableType] = [Text(record.verdict.headline, style="bold"), Text("")]
    parts += [Text(sentence) for sentence in record.verdict.sentences]
    parts += _list("Found in the run", record.findings, "bold red")
    parts += [Text(""), drawn(success, one_line=True), Text(""), drawn(effects, one_line=True)]
    parts += _list("What would change this", record.verdict.would_change, "bold")
    return Group(*parts)


_WITHOUT_VOID = tuple(name for name in _EFFECTS if name != "void")


def _list(title: str, items: tuple[str, ...], style: str) -> list[RenderableType]:
    if not items:
        return []
    points = (Padding(Text(f"- {item}"), (0, 0, 0, 2)) for item in items)
    return [Text(""), Text(title, style=style), *points]
