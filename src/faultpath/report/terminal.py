"""What the command line prints of a decision record, as rich renderables."""

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from faultpath.record.model import DecisionRecord
from faultpath.report import wording


def success_table(record: DecisionRecord) -> Table:
    """Return success by variant and path: what each cell of the audit came to."""
    asked = record.question
    table = _table("Success, %")
    table.add_column("variant", no_wrap=False)
    for path in record.paths:
        table.add_column(Text(path.title), justify="right")
    for variant in (asked.baseline, asked.repair):
        cells = {cell.path: cell for cell in record.cells if cell.variant == variant}
        texts = [
            Text(wording.plain(cells[p.name].success_percent)) if p.name in cells else Text("–")
            for p in record.paths
        ]
        table.add_row(Text(variant), *texts)
    return table


def effect_table(record: DecisionRecord) -> Table:
    """Return the effects path by path, with what stands behind them; bold is decided."""
    titles = {path.name: path.title for path in record.paths}
    breaks = {b.path: wording.break_even(b.result) for b in record.break_even}
    asked = record.question
    table = _table(f"{asked.repair} minus {asked.baseline}")
    table.add_column("path")
    for head in ("difference, pp", "won:lost", "p, Holm", "scenes", "break-even, %"):
        table.add_column(head, justify="right", no_wrap=True)
    for effect in record.effects:
        scenes = Text(str(effect.scenes))
        if effect.void_pairs:
            scenes.append(f", {effect.void_pairs} void", style="bold red")
        title = Text(titles.get(effect.path, effect.path))
        notes = ["primary"] if effect.path == asked.primary else []
        notes += filter(None, [wording.reservation(effect)])
        if notes:
            title.append(f" ({', '.join(notes)})", style="dim")
        table.add_row(
            title,
            Text(wording.with_interval(effect.success), style="bold" if effect.detected else ""),
            wording.wins_losses(effect.wins, effect.losses),
            wording.adjusted(effect),
            scenes,
            breaks.get(effect.path, "–"),
        )
    return table


def decision(record: DecisionRecord) -> RenderableType:
    """Return the decision record as text and tables: verdict, effects, what would change it."""
    parts: list[RenderableType] = [Text(record.verdict.headline, style="bold"), Text("")]
    parts += [Text(sentence) for sentence in record.verdict.sentences]
    if record.findings:
        parts += [Text(""), Text("Found in the run", style="bold red")]
        parts += [Padding(Text(f"- {item}"), (0, 0, 0, 2)) for item in record.findings]
    parts += [Text(""), success_table(record), Text(""), effect_table(record)]
    if record.verdict.would_change:
        parts += [Text(""), Text("What would change this", style="bold")]
        parts += [Padding(Text(f"- {item}"), (0, 0, 0, 2)) for item in record.verdict.would_change]
    return Group(*parts)


def _table(title: str) -> Table:
    return Table(
        title=Text(title), title_justify="left", box=None, pad_edge=False, padding=(0, 2, 0, 0)
    )
