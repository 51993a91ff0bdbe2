"""Logs of Inspect: JSON, or a zip of it that is called `.eval`."""

import hashlib
import io
import json
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from typing import Any, cast

from faultpath.core.files.opening import LARGEST_TEXT
from faultpath.core.files.parquet import Unreadable, unpacked
from faultpath.core.files.plain import Misread, read_json
from faultpath.core.text import listed
from faultpath.trials.received.question import JudgeQuestion

LARGEST = 2**30
"""Bytes of a log, and of all that is packed into it."""
_ZSTANDARD = 93
"""How new logs are packed; Python's own reader of zip files does not know it before 3.14."""
_GRADES = {"C": 1.0, "P": 0.5, "I": 0.0, "N": 0.0}
"""Correct, partly, incorrect, no answer: as Inspect itself counts them."""


def unzipped(data: bytes) -> dict[str, Any]:
    """Return the log in a zip file as its JSON would be; `Misread` for what is none."""
    try:
        archive = zipfile.ZipFile(io.BytesIO(data))
        files = {file.filename: file for file in archive.infolist()}
        if "header.json" not in files:
            raise Misread("holds no header.json, and is no finished log of Inspect")
        samples = sorted(name for name in files if name.startswith("samples/"))
        if sum(files[name].file_size for name in samples) > LARGEST:
            raise Misread(f"unpacks to more than {LARGEST / 2**30:g} GiB; give it in parts")
        log = read_json(_member(archive, files["header.json"], data))
        return {**log, "samples": [read_json(_member(archive, files[n], data)) for n in samples]}
    except (zipfile.BadZipFile, RuntimeError, struct.error, zlib.error, Unreadable) as error:
        raise Misread(f"is no sound zip file ({error})") from None


def _member(archive: zipfile.ZipFile, file: zipfile.ZipInfo, data: bytes) -> bytes:
    if file.file_size > LARGEST_TEXT:
        raise Misread(f"{file.filename} unpacks to more than {LARGEST_TEXT / 2**20:.0f} MiB")
    if file.compress_type != _ZSTANDARD:
        with archive.open(file) as packed:
            return packed.read()
    name, extra = struct.unpack_from("<HH", data, file.header_offset + 26)
    start = file.header_offset + 30 + name + extra
    found = unpacked(data[start : start + file.compress_size], file.file_size)
    if zlib.crc32(found) != file.CRC:
        raise Misread(f"{file.filename} is damaged")
    return found


def cells(log: Mapping[str, Any], asked: JudgeQuestion) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the samples of a log: scenes by their id, seeds by the epoch, the arm by the model."""
    about, samples = log["eval"], cast("list[dict[str, Any]] | None", log.get("samples"))
    if samples is None:
        raise Misread("holds no samples; write the log with them")
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
                "arm": about["model"],
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
