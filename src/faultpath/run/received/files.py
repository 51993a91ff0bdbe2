"""Results of other tools, read as data: named columns, LeRobot, Inspect, lm-eval.

Nothing that a file names is run or imported, JSON is read strictly, and sizes have limits.
"""

import csv
import hashlib
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import Any, cast

from pydantic import BaseModel, ValidationError

from faultpath.core.errors import UserError
from faultpath.core.files.opening import LARGEST_TEXT, contents
from faultpath.core.files.parquet import Unreadable, read_rows
from faultpath.core.files.plain import Misread, read_json, text_of
from faultpath.core.text import listed, unknown
from faultpath.core.validation_messages import misfit_of
from faultpath.run.received import inspect_logs, lerobot
from faultpath.run.received.question import JudgeQuestion
from faultpath.run.received.trial import Received, ResultsFile, received

_READ = ("eval_info.json", "samples_*.jsonl", "*.eval", "????-??-??T*.json")
"""Patterns of files read from a folder and those in it; the last are Inspect's logs in JSON."""
_SAMPLES = re.compile(r"samples_(.+)_\d{4}-\d\d-\d\dT[\d.-]+\.jsonl")
_OF_SAMPLES = ("doc_id", "target", "filter", "metrics")

_MARKS = {";": ";", "\t": "TAB", "|": "|"}
"""What may stand in place of commas, and how messages show it."""

Cells = Iterator[tuple[str, Mapping[str, Any]]]
"""Each trial with where it stands in its file."""


def read_results(
    results: Sequence[str | PathLike[str]], question: JudgeQuestion
) -> tuple[list[Received], dict[str, str]]:
    """Return the trials in some files, and the SHA-256 of each file.

    A result is a file, a folder, or either with the variant of its trials before it: `mine=runs/a`,
    and the condition too, `mine@shared=runs/b`. Raises `UserError` for a file that cannot be read,
    and as `received`.
    """
    trials: list[Received] = []
    digests: dict[str, str] = {}
    for file in chain.from_iterable(_files(str(result)) for result in results):
        path = Path(file.path)
        try:
            data = contents(path, LARGEST_TEXT if path.suffix != ".eval" else inspect_logs.LARGEST)
            before = len(trials)
            for where, cells in _cells(path, data, question, file.variant):
                trials.append(received(f"{path}{where}", cells, file, question))
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


def _files(result: str) -> list[ResultsFile]:
    label, equals, rest = result.partition("=")
    if not equals or Path(result).exists():
        label, rest = "", result
    variant, _, condition = label.partition("@")
    place = Path(rest)
    if not place.is_dir():
        return [ResultsFile(rest, variant, condition)]
    inside = sorted({file for pattern in _READ for file in place.rglob(pattern)})
    if not inside:
        raise UserError(f"{place} holds none of {', '.join(_READ)}: name the files themselves.")
    return [ResultsFile(str(file), variant, condition) for file in inside]


def _cells(path: Path, data: bytes, question: JudgeQuestion, label: str) -> Cells:
    match path.suffix:
        case ".csv":
            yield from _named(_csv(text_of(data)), question)
        case ".parquet":
            yield from _named(((f", row {n}", row) for n, row in read_rows(data)), question)
        case ".eval":
            yield from inspect_logs.cells(inspect_logs.unpacked(path), question, label)
        case ".jsonl":
            lines = text_of(data).split("\n")  # other line separators may stand in a text
            rows = [
                (f", line {n}", _object(line.encode(), n))
                for n, line in enumerate(lines, 1)
                if line.strip()
            ]
            if rows and "doc_id" in rows[0][1]:
                yield from _samples(path, rows, question)
            else:
                yield from _named(iter(rows), question)
        case ".json":
            log = _object(data)
            if "eval" in log:
                yield from inspect_logs.cells(log, question, label)
            else:
                yield from lerobot.cells(log)
        case _:
            raise Misread("is of no kind that is read; give .csv, .parquet, .json, .jsonl or .eval")


def _object(data: bytes, line: int | None = None) -> dict[str, Any]:
    try:
        content = read_json(data)
    except Misread as error:
        raise Misread(str(error), line or error.line) from None
    if isinstance(content, dict):
        return cast("dict[str, Any]", content)
    raise Misread("is no group of fields, {...}", line)


def _csv(text: str) -> Cells:
    rows = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        names = next(rows, list[str]())
        if twice := [name for at, name in enumerate(names) if name in names[:at]]:
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
    """Yield trials by the names that are asked for; a column that was named has to be there."""
    for where, row in rows:
        for name, column in question.columns.items():
            if column not in row:
                raise Misread(f"--column {name}={column}: {unknown('column', column, row)}")
        yield where, {**row, **{name: row[column] for name, column in question.columns.items()}}


class _Document(BaseModel):
    """Document of lm-eval, beside its metrics."""

    doc_id: Any
    doc_hash: Any = None
    filter: str = "none"
    metrics: list[str] | None = None


def _samples(
    path: Path, rows: Sequence[tuple[str, dict[str, Any]]], question: JudgeQuestion
) -> Cells:
    """Yield the documents of lm-eval's `samples_<task>_<date>.jsonl`, by the hash of each."""
    named = _SAMPLES.fullmatch(path.name)
    task = named[1] if named else path.stem
    metric, _, filter_name = question.columns.get("success", "").partition(",")
    documents = [_document(where, row) for where, row in rows]
    filters = list(dict.fromkeys(document.filter for document in documents))
    metrics = documents[0].metrics or [
        name
        for name, value in rows[0][1].items()
        if isinstance(value, int | float) and name not in _OF_SAMPLES
    ]
    if not metrics:
        raise Misread("names no metric, and has no number that could be one; give --column success")
    metric = metric or (metrics[0] if len(metrics) == 1 else "")
    filter_name = filter_name or (filters[0] if len(filters) == 1 else "")
    if metric not in metrics or filter_name not in filters:
        raise Misread(
            f"has the metrics {listed(metrics)} and the filters {listed(filters)}; say "
            f"which of them is success, as in --column success={metrics[0]},{filters[0]}"
        )
    for (where, row), document in zip(rows, documents, strict=True):
        if document.filter == filter_name:
            same = {"task": task, "scene": document.doc_id, "initial": document.doc_hash}
            yield where, {**row, **same, "success": row.get(metric)}


def _document(where: str, row: Mapping[str, Any]) -> _Document:
    try:
        return _Document.model_validate(row)
    except ValidationError as error:
        raise Misread(f"{where.removeprefix(', ')}: {misfit_of(error)}") from None
