"""Logs of Inspect: JSON, read here, or `.eval`, read by the package inspect_ai."""

import hashlib
import json
import zipfile
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from faultpath.core.files.opening import most_unpacked
from faultpath.core.files.plain import Misread
from faultpath.core.text import extra, listed
from faultpath.run.received.question import JudgeQuestion

LARGEST = 2**30
"""Bytes of a log."""
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


class _About(BaseModel):
    model: str
    task: str


class _Log(BaseModel):
    eval: _About
    samples: list[_Sample] | None = None


def unpacked(path: Path) -> dict[str, Any]:
    """Return an `.eval` log as its JSON would be; `Misread` for what is none.

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


def cells(
    log: Mapping[str, Any], question: JudgeQuestion, label: str = ""
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the samples of a log: scenes by their id, seeds by the epoch, the variant by the model,
    or by `label` where the model is not called as a variant."""
    read = _Log.model_validate(log)
    if read.samples is None:
        raise Misread("holds no samples; write the log with them")
    model = read.eval.model
    model = label if label and model not in (question.baseline, question.repair) else model
    scorer = question.columns.get("success", "")
    for sample in read.samples:
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
                "variant": model,
                "task": read.eval.task,
                "scene": sample.id,
                "seed": sample.epoch,
                "success": _GRADES.get(value, value) if isinstance(value, str) else value,
                "initial": _asked(sample),
                "time_s": sample.total_time or None,
                "error": (sample.error and sample.error.message) or "it has no score",
            },
        )


def _asked(sample: _Sample) -> str:
    """Return a hash of what the model was asked; of messages their ids, which vary, left out."""
    prompt: Any = sample.input
    if not isinstance(prompt, str):
        prompt = [(message.get("role"), str(message.get("content"))) for message in prompt or ()]
    text = json.dumps([prompt, sample.target], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
