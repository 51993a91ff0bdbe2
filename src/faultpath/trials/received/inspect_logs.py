"""Logs of Inspect: JSON, or a zip of it that is called `.eval`."""

import hashlib
import io
import json
import struct
import zipfile
import zlib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, cast

from faultpath.core.files.opening import most_unpacked
from faultpath.core.files.parquet import unpacked
from faultpath.core.files.plain import Misread, read_json
from faultpath.core.text import listed
from faultpath.trials.received.question import JudgeQuestion

LARGEST = 2**30
"""Bytes of a log."""
_LARGEST_SAMPLE = 2**26
"""Bytes of one sample of a packed log, which is read by itself."""
UNSOUND = (zipfile.BadZipFile, zlib.error, struct.error, RuntimeError, OSError)
"""Errors that damaged zip files raise."""
_ZSTANDARD = 93
"""How new logs are packed; Python's own reader of zip files does not know it before 3.14."""
_GRADES = {"C": 1.0, "P": 0.5, "I": 0.0, "N": 0.0}
"""Correct, partly, incorrect, no answer: as Inspect itself counts them."""


def unzipped(data: bytes) -> dict[str, Any]:
    """Return the log in a zip file as its JSON would be, its samples read one by one; `Misread` or
    one of `UNSOUND` for what is none."""
    archive = zipfile.ZipFile(io.BytesIO(data))
    files = {file.filename: file for file in archive.infolist()}
    if "header.json" not in files:
        raise Misread("holds no header.json, and is no finished log of Inspect")
    samples = [files[name] for name in sorted(files) if name.startswith("samples/")]
    if sum(file.file_size for file in samples) > (most := most_unpacked(len(data))):
        raise Misread(f"unpacks to more than {most / 2**20:.0f} MiB; give it in parts")
    log = read_json(_member(archive, files["header.json"], data))
    return {**log, "samples": (read_json(_member(archive, each, data)) for each in samples)}


def _member(archive: zipfile.ZipFile, file: zipfile.ZipInfo, data: bytes) -> bytes:
    if file.file_size > _LARGEST_SAMPLE:
        raise Misread(f"{file.filename} unpacks to more than {_LARGEST_SAMPLE / 2**20:.0f} MiB")
    # Other methods would unpack without a bound.
    if file.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, _ZSTANDARD):
        raise Misread(
            f"{file.filename} is not packed as Inspect packs its logs; write the log again"
        )
    if file.compress_type != _ZSTANDARD:
        with archive.open(file) as packed:
            return packed.read()
    name, extra = struct.unpack_from("<HH", data, file.header_offset + 26)
    start = file.header_offset + 30 + name + extra
    found = unpacked(data[start : start + file.compress_size], file.file_size)
    if zlib.crc32(found) != file.CRC:
        raise Misread(f"{file.filename} is damaged")
    return found


def cells(
    log: Mapping[str, Any], asked: JudgeQuestion, label: str = ""
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the samples of a log: scenes by their id, seeds by the epoch, the arm by the model, or
    by `label` where the model is not called as an arm."""
    about, samples = log["eval"], cast("Iterable[dict[str, Any]] | None", log.get("samples"))
    if samples is None:
        raise Misread("holds no samples; write the log with them")
    model = about["model"]
    model = label if label and model not in (asked.baseline, asked.repair) else model
    wanted = asked.columns.get("success", "")
    for sample in samples:
        scores: dict[str, Any] = sample.get("scores") or {}
        wrong: dict[str, Any] = sample.get("error") or {}
        where = f", sample {sample['id']}"
        name = wanted or (next(iter(scores)) if len(scores) == 1 else "")
        if scores and name not in scores:
            raise Misread(
                f"sample {sample['id']} is scored by {listed(scores)}; say which of them is "
                f"success, as in --column success={next(iter(scores))}"
            )
        value = None if wrong or not scores else scores[name]["value"]
        yield (
            where,
            {
                "arm": model,
                "task": about["task"],
                "scene": sample["id"],
                "seed": sample.get("epoch", 1),
                "success": _GRADES.get(value, value) if isinstance(value, str) else value,
                "initial": _asked(sample),
                "time_s": sample.get("total_time") or None,
                "error": wrong.get("message") or "it has no score",
            },
        )


def _asked(sample: Mapping[str, Any]) -> str:
    """Return a hash of what the model was asked; of messages their ids, which vary, left out."""
    given = sample.get("input")
    if not isinstance(given, str):
        messages = cast("list[dict[str, Any]]", given or [])
        given = [(each.get("role"), str(each.get("content"))) for each in messages]
    text = json.dumps([given, sample.get("target")], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
