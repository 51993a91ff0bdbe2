"""Results of other tools, read as data: from their files to trials, and how each ended.

Nothing that a file names is run or imported, JSON is read strictly, and sizes have limits.
"""

import csv
import hashlib
import math
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO, TextIOWrapper
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import Any, cast

from pydantic import ValidationError

from faultpath.core.errors import UserError
from faultpath.core.files.opening import LARGEST_TEXT, contents
from faultpath.core.files.parquet import Unreadable, read_rows
from faultpath.core.files.plain import Misread, read_json, text_of
from faultpath.core.text import number_of, series, unknown
from faultpath.core.validation_messages import misfit_of
from faultpath.run.received.formats import (
    LARGEST_LOG,
    Cells,
    inspect_cells,
    lerobot_cells,
    lm_eval_cells,
    unpacked_log,
)
from faultpath.run.received.question import JudgeQuestion
from faultpath.system.declared import check_name, shown
from faultpath.system.outcome import Status

_PATTERNS = ("eval_info.json", "samples_*.jsonl", "*.eval", "????-??-??T*.json")
"""Patterns of files read from a folder and those in it; the last are Inspect's logs in JSON."""
_MARKS = {";": ";", "\t": "TAB", "|": "|"}
"""Marks that may stand in place of commas, and how messages show them."""
_ENDS = {status.value: status for status in Status}
_TRUTH = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
_NO_METRICS: Mapping[str, float] = {}
"""One for all trials without any."""
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
    """Reason why a failed one has no outcome."""


@dataclass(frozen=True)
class _ResultsFile:
    """A file with what the command line says of all its trials."""

    path: str
    variant: str = ""
    condition: str = ""


def read_results(
    results: Sequence[str | PathLike[str]], question: JudgeQuestion
) -> tuple[list[Received], dict[str, str]]:
    """Return the trials in some files, and the SHA-256 of each file.

    A result is a file, a folder, or either with the variant of its trials before it: `mine=runs/a`,
    and the condition too, `mine@shared=runs/b`. `UserError` for a file that cannot be read, for a
    trial without a variant, scene or success, and for cells that cannot be.
    """
    trials: list[Received] = []
    digests: dict[str, str] = {}
    for file in chain.from_iterable(_files(str(result)) for result in results):
        path = Path(file.path)
        try:
            data = contents(path, LARGEST_LOG if path.suffix == ".eval" else LARGEST_TEXT)
            before = len(trials)
            for where, cells in _cells(path, data, question, file.variant):
                trials.append(_trial(f"{path}{where}", cells, file, question))
            if len(trials) == before:
                raise Misread("holds no trial; give a file with one in each row")
        except OSError as error:
            raise UserError(f"{path}: cannot be read ({error.strerror}): give a file.") from None
        except Misread as error:
            raise UserError(f"{error.at(path)}.") from None
        except ValidationError as error:  # of a part that another tool lays out
            raise UserError(f"{path}: {misfit_of(error)}.") from None
        except Unreadable as error:
            raise UserError(f"{path}: cannot be read ({error}): write it anew.") from None
        digests[str(path)] = hashlib.sha256(data).hexdigest()
    return trials, digests


def _files(result: str) -> list[_ResultsFile]:
    label, equals, rest = result.partition("=")
    if not equals or Path(result).exists():
        label, rest = "", result
    variant, _, condition = label.partition("@")
    place = Path(rest)
    if not place.is_dir():
        return [_ResultsFile(rest, variant, condition)]
    inside = sorted({file for pattern in _PATTERNS for file in place.rglob(pattern)})
    if not inside:
        raise UserError(f"{place} holds none of {', '.join(_PATTERNS)}: name the files themselves.")
    return [_ResultsFile(str(file), variant, condition) for file in inside]


def _cells(path: Path, data: bytes, question: JudgeQuestion, label: str) -> Cells:
    match path.suffix:
        case ".csv":
            yield from _named(_csv(data), question)
        case ".parquet":
            yield from _named(((f", row {n}", row) for n, row in read_rows(data)), question)
        case ".eval":
            _check_columns(question, "a log of Inspect", ("success",))
            yield from inspect_cells(unpacked_log(path), question, label)
        case ".jsonl":
            rows = _lines(data)
            first = next(rows, None)
            if first and "doc_id" in first[1]:
                _check_columns(question, "a file of lm-eval", ("success",))
                yield from lm_eval_cells(path, [first, *rows], question)
            elif first:
                yield from _named(chain([first], rows), question)
        case ".json":
            content = _object(data)
            if "eval" in content:
                _check_columns(question, "a log of Inspect", ("success",))
                yield from inspect_cells(content, question, label)
            else:
                if not content.keys().isdisjoint(("per_task", "per_episode")):
                    _check_columns(question, "a file of LeRobot", ())
                yield from lerobot_cells(content)
        case _:
            raise Misread("is of no kind that is read; give .csv, .parquet, .json, .jsonl or .eval")


def _check_columns(question: JudgeQuestion, kind: str, taken: Sequence[str]) -> None:
    """Raise `Misread` for a column that is named and that this kind of file does not take."""
    if other := [name for name in question.columns if name not in taken]:
        raise Misread(f"is {kind}, which has its own columns; leave out --column {other[0]}=...")


def _object(data: bytes, line: int | None = None) -> dict[str, Any]:
    try:
        content = read_json(data)
    except Misread as error:
        raise Misread(str(error), line or error.line) from None
    if isinstance(content, dict):
        return cast("dict[str, Any]", content)
    raise Misread("is no group of fields, {...}", line)


def _lines(data: bytes) -> Iterator[tuple[str, dict[str, Any]]]:
    for number, line in enumerate(BytesIO(data), 1):  # other separators may stand in a text
        if line.strip():
            yield f", line {number}", _object(line, number)


def _csv(data: bytes) -> Cells:
    text_of(data)  # refuses what is no text; as one, it would stay in memory as long as the rows
    rows = csv.reader(TextIOWrapper(BytesIO(data), "utf-8-sig", newline=""), strict=True)
    try:
        names = next(rows, list[str]())
        if twice := [name for name, count in Counter(names).items() if count > 1]:
            raise Misread(f"column '{twice[0]}' appears twice; drop one", 1)
        if len(names) == 1 and (mark := next((m for m in _MARKS if m in names[0]), "")):
            raise Misread(f"separates its columns by '{_MARKS[mark]}'; separate them by ','", 1)
        for row in filter(None, rows):
            if len(row) != len(names):
                problem = f"has {len(row)} cells where the first line names {len(names)} columns"
                raise Misread(problem, rows.line_num)
            yield f", line {rows.line_num}", dict(zip(names, row, strict=True))
    except csv.Error as error:
        raise Misread(f"is not CSV ({error})", rows.line_num) from None


def _named(rows: Cells, question: JudgeQuestion) -> Cells:
    """Yield trials by the names of `COLUMNS`; a column that was named has to be there."""
    for where, row in rows:
        for name, column in question.columns.items():
            if column not in row:
                raise Misread(f"--column {name}={column}: {unknown('column', column, row)}")
        yield where, {**row, **{name: row[column] for name, column in question.columns.items()}}


def _trial(
    where: str, cells: Mapping[str, Any], file: _ResultsFile, question: JudgeQuestion
) -> Received:
    """Return the trial in `cells`, by the names of `COLUMNS` and of metrics."""
    texts = {
        name: _text(cells.get(name), f"{where}: the {name}")
        for name in ("variant", "scene", "condition", "task", "seed", "initial")
    }
    for name, label in (("variant", file.variant), ("condition", file.condition)):
        # A label at the wrong file would turn the result round.
        if label and texts[name] and label != texts[name]:
            raise UserError(
                f"{where}: the file says {name} '{texts[name]}' and the command line '{label}': "
                f"leave one of them out, or name another column with --column {name}=NAME."
            )
        texts[name] = sys.intern(label or texts[name])  # one text for all of its trials
    there = {
        "variant": texts["variant"],
        "scene": texts["scene"],
        "success": "success" in cells,
    }
    if missing := [name for name, is_there in there.items() if not is_there]:
        columns = " ".join(f"--column {name}=NAME" for name in missing)
        before = f"; a version may stand before the file, as in {question.repair}={file.path}"
        raise UserError(
            f"{where} has no {series(missing)}: name the {'columns' if missing[1:] else 'column'} "
            f"with {columns}{'' if texts['variant'] else before}."
        )
    for name, text in texts.items():
        if text:
            check_name(f"{where}: the {name}", text)
    status = _status(cells["success"], where, question.success_from)
    seconds = f"{where}: {question.columns.get('time_s', 'time_s')}"
    time_s = _number(cells.get("time_s"), seconds)
    if time_s is not None and time_s <= 0.0:
        raise UserError(f"{seconds} is {time_s:g}: give seconds above 0, or leave it empty.")
    metrics = _NO_METRICS
    for name in (metric.partition(":")[0] for metric in question.metrics):
        if name not in cells:
            raise UserError(f"{where}: {unknown('metric', name, map(str, cells))}.")
        value = _number(cells[name], f"{where}: {name}")
        metrics = metrics if value is None else {**metrics, name: value}
    return Received(
        **texts,
        where=where,
        status=status,
        time_s=math.nan if time_s is None else time_s,
        metrics=metrics,
        error=str(cells.get("error") or NO_OUTCOME) if status is Status.FAILED else "",
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
    """Return how a trial ended; without an outcome it counts as failed."""
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
            "--success-from, or success, crash, timeout, or failed for a trial without an outcome."
        ) from None
    if least is None and score not in (0.0, 1.0):
        raise UserError(
            f"{where}: success is {score:g}: give 0 or 1, or say with --success-from from which "
            "score on a trial counts as a success."
        )
    return Status.SUCCESS if score >= (1.0 if least is None else least) else Status.TIMEOUT
