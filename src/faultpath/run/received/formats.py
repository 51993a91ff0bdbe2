"""Layouts of other tools' results: LeRobot, Inspect (JSON here, `.eval` by inspect_ai), lm-eval."""

import hashlib
import json
import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from faultpath.core.files.opening import most_unpacked
from faultpath.core.files.plain import Misread
from faultpath.core.text import extra, listed
from faultpath.core.validation_messages import misfit_of
from faultpath.run.received.question import JudgeQuestion

Cells = Iterator[tuple[str, Mapping[str, Any]]]
"""Each trial with where it stands in its file."""


class _Episode(BaseModel):
    model_config = ConfigDict(extra="allow")

    episode_ix: Any
    seed: Any


class _Metrics(BaseModel):
    success: list[Any] = Field(alias="successes")
    sum_reward: list[Any] | None = Field(default=None, alias="sum_rewards")
    max_reward: list[Any] | None = Field(default=None, alias="max_rewards")

    @model_validator(mode="after")
    def _of_one_length(self) -> Self:
        if len({len(values) for _, values in self if values is not None}) > 1:
            raise ValueError("holds lists of different lengths, and must have one entry an episode")
        return self


class _Task(BaseModel):
    task_group: Any
    task_id: Any
    metrics: _Metrics


class _EvalInfo(BaseModel):
    per_episode: list[_Episode] | None = None
    per_task: list[_Task] | None = None


def lerobot_cells(content: Mapping[str, Any]) -> Cells:
    """Yield the episodes of LeRobot's `eval_info.json`: by task and place, or by seed as before
    there were tasks."""
    info = _EvalInfo.model_validate(content)
    if info.per_episode is not None:
        for number, episode in enumerate(info.per_episode):
            seed = episode.seed
            scene = f"episode {episode.episode_ix}" if seed is None else f"seed {seed}"
            yield f", episode {number}", {**episode.model_dump(), "scene": scene, "seed": None}
    elif info.per_task is not None:
        for evaluation in info.per_task:
            task = f"{evaluation.task_group}/{evaluation.task_id}"
            columns = evaluation.metrics.model_dump(exclude_none=True)
            for number, row in enumerate(zip(*columns.values(), strict=True)):
                scene = f"episode {number}"
                cells = dict(zip(columns, row, strict=True))
                yield f", {task}, {scene}", {**cells, "task": task, "scene": scene}
    else:
        raise Misread(
            "is neither LeRobot's eval_info.json (per_task or per_episode) nor a log of Inspect "
            "(eval and samples); give one of these, or columns as CSV"
        )


LARGEST_LOG = 2**30
"""Bytes of a packed log of Inspect."""
_GRADES = {"C": 1.0, "P": 0.5, "I": 0.0, "N": 0.0}
"""Correct, partly, incorrect, no answer: as Inspect itself counts them."""


class _Score(BaseModel):
    value: Any


class _Error(BaseModel):
    message: str = ""


class _Sample(BaseModel):
    id: Any
    epoch: Any = 1
    input: str | list[dict[str, Any]] | None = None
    target: Any = None
    scores: dict[str, _Score] | None = None
    error: _Error | None = None
    total_time: Any = None


class _Eval(BaseModel):
    model: str
    task: str


class _Log(BaseModel):
    eval: _Eval
    samples: list[_Sample] | None = None


def unpacked_log(path: Path) -> dict[str, Any]:
    """Return an `.eval` log of Inspect as its JSON would be; `Misread` for what is none.

    Needs inspect_ai, the package that writes these logs.
    """
    try:
        read_eval_log = import_module("inspect_ai.log").read_eval_log
    except ImportError:
        raise Misread(
            "is a packed log of Inspect, which the package inspect_ai reads, not installed here: "
            f"{extra('inspect')}; or give the log as JSON, by `inspect log convert --to json`"
        ) from None
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(file.file_size for file in archive.infolist())
        if size > (most := most_unpacked(path.stat().st_size)):
            raise Misread(f"unpacks to more than {most / 2**20:.0f} MiB; give it in parts")
        log: Any = read_eval_log(str(path))
    except Misread:
        raise
    except Exception as error:  # whatever a package of other people raises of a damaged file
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise Misread(f"is no sound log of Inspect ({reason})") from None
    samples = log.samples
    if samples is not None:
        samples = [sample.model_dump(include=set(_Sample.model_fields)) for sample in samples]
    return {"eval": {"model": log.eval.model, "task": log.eval.task}, "samples": samples}


def inspect_cells(content: Mapping[str, Any], question: JudgeQuestion, label: str) -> Cells:
    """Yield the samples of a log of Inspect: scenes by their id, seeds by the epoch, the variant by
    the model, or by `label` where the model is not called as a variant."""
    log = _Log.model_validate(content)
    if log.samples is None:
        raise Misread("holds no samples; write the log with them")
    model = log.eval.model
    variant = label if label and model not in (question.baseline, question.repair) else model
    scorer = question.columns.get("success", "")
    for sample in log.samples:
        scores = sample.scores or {}
        name = scorer or (next(iter(scores)) if len(scores) == 1 else "")
        if scores and name not in scores:
            raise Misread(
                f"sample {sample.id} is scored by {listed(scores)}; say which of them is "
                f"success, as in --column success={next(iter(scores))}"
            )
        value = None if sample.error or not scores else scores[name].value
        yield (
            f", sample {sample.id}",
            {
                "variant": variant,
                "task": log.eval.task,
                "scene": sample.id,
                "seed": sample.epoch,
                "success": _GRADES.get(value, value) if isinstance(value, str) else value,
                "initial": _prompt_hash(sample),
                "time_s": sample.total_time or None,
                "error": (sample.error and sample.error.message) or "it has no score",
            },
        )


def _prompt_hash(sample: _Sample) -> str:
    prompt: Any = sample.input
    if not isinstance(prompt, str):  # of messages without their ids, which vary
        prompt = [(message.get("role"), str(message.get("content"))) for message in prompt or ()]
    text = json.dumps([prompt, sample.target], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


_SAMPLES = re.compile(r"samples_(.+)_\d{4}-\d\d-\d\dT[\d.-]+\.jsonl")
_OF_SAMPLES = ("doc_id", "target", "filter", "metrics")


class _Document(BaseModel):
    """Document of lm-eval, beside its metrics."""

    doc_id: Any
    doc_hash: Any = None
    filter: str = "none"
    metrics: list[str] | None = None


def lm_eval_cells(
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
