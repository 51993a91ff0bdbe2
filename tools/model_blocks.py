"""Marked block of the documents about the models that ship: the end of each fit, from its card."""

import json
from typing import Any

from blocks import Wrong
from faultpath_quadrotor.checkpoint import shipped_folder
from faultpath_quadrotor.training.catalogue import ALL

from faultpath.decisions.sentences import wording
from faultpath.decisions.tables import Line, Table, line
from faultpath.decisions.tables.markdown import grid

MEASURES = {
    "position_error_20_m": "position after 20 steps, m",
    "wind_rmse_mps": "wind, m/s",
    "error_m": "clearance, m",
}
"""Errors on held-out windows that a card may have, with their names in words."""
COLUMNS = ("What it is", "Parameters", "Samples", "Error of", "By seed")


def table() -> str:
    """Return every model with its error on the windows that its fit left out, seed by seed."""
    lines: list[Line] = []
    for entry in ALL:
        cards = [_card(f"{entry.name}-{seed}") for seed in entry.seeds]
        last = cards[0]["validation"][-1]
        measure = next(name for name in MEASURES if name in last)
        errors = [wording.plain(card["validation"][-1][measure], 3) for card in cards]
        sizes = (f"{cards[0][name]:,}" for name in ("parameters", "samples"))
        columns = (entry.description, *sizes, MEASURES[measure], " / ".join(errors))
        lines.append(line(entry.name, *columns, name=True))
    return grid(Table(corner="Model", columns=COLUMNS, words=COLUMNS, lines=tuple(lines)))


def _card(stem: str) -> dict[str, Any]:
    file = shipped_folder() / f"{stem}.json"
    if not file.is_file():
        raise Wrong(f"{stem} has no card: fit it with make train and ship it")
    return json.loads(file.read_text("utf-8"))
