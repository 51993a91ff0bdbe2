"""One trial as another tool wrote it: from cells to what ended how."""

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from faultpath.core.errors import UserError
from faultpath.core.numbers import number_of
from faultpath.core.text import series, unknown
from faultpath.run.received.question import JudgeQuestion
from faultpath.system.declared import check_name, shown
from faultpath.system.outcome import Status

_ENDS = {status.value: status for status in Status}
_TRUTH = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
NO_OUTCOME = "the results give no outcome"


@dataclass(frozen=True, slots=True)
class Received:
    """One trial."""

    where: str
    """File and line, or what else finds it there."""
    variant: str
    condition: str
    task: str
    scene: str
    seed: str
    status: Status
    initial: str
    """A hash of what it began with; empty where none is given."""
    time_s: float
    """Not a number where none is given."""
    metrics: Mapping[str, float] = field(default_factory=dict[str, float])
    error: str = ""
    """Why it says nothing, of a failed one."""


@dataclass(frozen=True)
class ResultsFile:
    """A file with what the command line says of all its trials."""

    path: str
    variant: str = ""
    condition: str = ""

    def label(self, name: str, cells: Mapping[str, Any], where: str) -> str:
        """Return variant or condition of a trial; `UserError` where line and file say different
        ones, since a label at the wrong file would turn the result round."""
        label, cell = getattr(self, name), _text(cells.get(name), f"{where}: the {name}")
        if label and cell and label != cell:
            raise UserError(
                f"{where}: the file says {name} '{cell}' and the command line '{label}': leave one "
                f"of them out, or name another column with --column {name}=NAME."
            )
        return sys.intern(label or cell)  # one text for all of its trials


def received(
    where: str, cells: Mapping[str, Any], file: ResultsFile, question: JudgeQuestion
) -> Received:
    """Return the trial in `cells`, by the names of `COLUMNS` and of metrics.

    `UserError` for a trial without a variant, scene or success, and for cells that cannot be.
    """
    variant, condition = file.label("variant", cells, where), file.label("condition", cells, where)
    scene = _text(cells.get("scene"), f"{where}: the scene")
    there = {"variant": variant, "scene": scene, "success": "success" in cells}
    if missing := [name for name, is_there in there.items() if not is_there]:
        columns = " ".join(f"--column {name}=NAME" for name in missing)
        before = f"; a version may stand before the file, as in {question.repair}={file.path}"
        raise UserError(
            f"{where} has no {series(missing)}: name the {'columns' if missing[1:] else 'column'} "
            f"with {columns}{'' if variant else before}."
        )
    more = ("task", "seed", "initial")
    texts = {name: _text(cells.get(name), f"{where}: the {name}") for name in more}
    for name, text in {"variant": variant, "scene": scene, "condition": condition, **texts}.items():
        if text:
            check_name(f"{where}: the {name}", text)
    status = _status(cells["success"], where, question.success_from)
    seconds = f"{where}: {question.columns.get('time_s', 'time_s')}"
    time_s = _number(cells.get("time_s"), seconds)
    if time_s is not None and time_s <= 0.0:
        raise UserError(f"{seconds} is {time_s:g}: give seconds above 0, or leave it empty.")
    metrics: dict[str, float] = {}
    for name in (metric.partition(":")[0] for metric in question.metrics):
        if name not in cells:
            raise UserError(f"{where}: {unknown('metric', name, map(str, cells))}.")
        value = _number(cells[name], f"{where}: {name}")
        metrics |= {} if value is None else {name: value}
    return Received(
        where,
        variant,
        condition,
        texts["task"],
        scene,
        texts["seed"],
        status,
        texts["initial"],
        math.nan if time_s is None else time_s,
        metrics,
        str(cells.get("error") or NO_OUTCOME) if status is Status.FAILED else "",
    )


def _text(cell: object, what: str) -> str:
    """Return a name: `3` for 3.0 too, which is how a column of whole numbers with a gap is read."""
    if isinstance(cell, str):
        return cell.strip()
    if isinstance(cell, float) and cell.is_integer():
        cell = int(cell)
    if isinstance(cell, list | dict | bytes):
        raise UserError(f"{what} is {shown(cell)}: give a word or a number.")
    return "" if cell is None or cell != cell else str(cell)


def _number(cell: object, what: str) -> float | None:
    if cell is None or cell == "" or cell != cell:
        return None
    try:
        return number_of(cell)
    except ValueError as error:
        raise UserError(f"{what} is {shown(cell)}: give {error}, or leave it empty.") from None


def _status(cell: object, where: str, least: float | None) -> Status:
    """Return how a trial ended; a cell without an outcome is a trial that says nothing."""
    word = cell.strip().lower() if isinstance(cell, str) else cell
    if word is None or word == "" or word != word or word == "nan":
        return Status.FAILED
    if isinstance(word, str):
        if word in _ENDS:
            return _ENDS[word]
        word = _TRUTH.get(word, word)
    try:
        score = number_of(word)
    except ValueError as error:
        raise UserError(
            f"{where}: success is {shown(cell)}: give true or false, 1 or 0, {error} with "
            "--success-from, or success, crash, timeout, or failed for a trial that says nothing."
        ) from None
    if least is None and score not in (0.0, 1.0):
        raise UserError(
            f"{where}: success is {score:g}: give 0 or 1, or say with --success-from from which "
            "score on a trial counts as a success."
        )
    return Status.SUCCESS if score >= (1.0 if least is None else least) else Status.TIMEOUT
