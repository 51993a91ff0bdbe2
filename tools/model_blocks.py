"""Block about the models that ship: the end of each fit, from its card."""

import json
from typing import Any

from blocks import Wrong, words_grid
from faultpath_quadrotor.checkpoint import shipped_folder
from faultpath_quadrotor.training.catalogue import ALL

from faultpath.analyses.sentences import wording
from faultpath.analyses.tables import Line, line

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
        last = [card["validation"][-1] for card in cards]
        measure = next(name for name in MEASURES if name in last[0])
        errors = " / ".join(wording.plain(errors[measure], 3) for errors in last)
        sizes = (f"{cards[0][name]:,}" for name in ("parameters", "samples"))
        columns = (entry.description, *sizes, MEASURES[measure], errors)
        lines.append(line(entry.name, *columns, name=True))
    return words_grid("Model", COLUMNS, lines)


def _card(stem: str) -> dict[str, Any]:
    file = shipped_folder() / f"{stem}.json"
    if not file.is_file():
        raise Wrong(f"{stem} has no card: fit it with make train and ship it")
    return json.loads(file.read_text("utf-8"))
