"""Interfaces read from YAML and from data."""

import copy
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

from pydantic import ValidationError

from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents
from faultpath.core.files.plain import Misread, read_yaml
from faultpath.core.validation_messages import misfit_of
from faultpath.interface.interface import Interface


def read_interface(
    facts: Path | str | Mapping[str, Any],
    readers: Mapping[str, Sequence[str]] | None = None,
    writers: Mapping[str, Sequence[str]] | None = None,
) -> Interface:
    """Return the interface in a YAML file, in YAML text (a `str` with a line break), or in data.

    Readers and reconstructions that it does not list are taken from `readers` (by channel) and
    `writers` (modules by source), where these are given.

    Raises `UserError` with file, line and what to do.
    """
    if isinstance(facts, Mapping):
        data = copy.deepcopy(dict(facts))
        _complete(data, readers or {}, writers or {})
        try:
            return Interface.model_validate(data)
        except ValidationError as error:
            raise UserError(str(misfit_of(error, Interface))) from None
    where, text = "the interface text", b""
    if isinstance(facts, str) and "\n" in facts:
        text = facts.encode("utf-8", "surrogatepass")
    else:
        where = str(facts)
        try:
            text = contents(Path(facts))
        except OSError as error:
            raise UserError(
                f"{where}: cannot be read ({error.strerror}); give the path of an interface file"
            ) from None
    try:
        document = read_yaml(text)
        data = cast("dict[str, Any]", document.data)
        # YAML may hold anything.
        if not isinstance(data, dict):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise Misread("holds no interface; start with `name:`, `sources:`, `channels:`")
        _complete(data, readers or {}, writers or {})
        return document.fill(Interface)
    except Misread as error:
        raise UserError(error.at(where)) from None


def _complete(
    data: dict[str, Any],
    readers: Mapping[str, Sequence[str]],
    writers: Mapping[str, Sequence[str]],
) -> None:
    """Fill in readers and reconstructions; malformed data is left for validation."""
    for channel in _dicts(data, "channels"):
        if "readers" not in channel and channel.get("name") in readers:
            channel["readers"] = list(readers[channel["name"]])
    outputs: dict[str, list[str]] = {}
    for source in _dicts(data, "sources"):
        name: str = source["name"]
        if source.get("provenance") == "reconstructed":
            for module in writers.get(name, ()):
                outputs.setdefault(module, []).append(name)
    if outputs:
        data.setdefault("reconstructs", outputs)


def _dicts(data: dict[str, Any], part: str) -> list[dict[str, Any]]:
    items = data.get(part)
    entries = cast("list[Any]", items) if isinstance(items, list) else []
    return [
        cast("dict[str, Any]", entry)
        for entry in entries
        if isinstance(entry, dict) and isinstance(cast("dict[str, Any]", entry).get("name"), str)
    ]
