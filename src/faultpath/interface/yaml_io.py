"""Interfaces as YAML, written so that reading gives the same."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

from faultpath.errors import UserError
from faultpath.files.opening import contents
from faultpath.files.plain import Misread, read_yaml, yaml_text
from faultpath.interface.checks import Interface

_TEXT = "the interface text"


def read_interface(
    path_or_text: Path | str,
    consumers: Mapping[str, Sequence[str]] | None = None,
    writers: Mapping[str, str] | None = None,
) -> Interface:
    """Return the interface in a YAML file, or in YAML text (a `str` that has a line break).

    What the text does not say about who reads and who reconstructs is taken from `consumers`
    (by channel) and `writers` (module by source), where these are given.

    Raises `UserError` with file, line and what to do.
    """
    if isinstance(path_or_text, str) and "\n" in path_or_text:
        data = path_or_text.encode("utf-8", "surrogatepass")
        return _parse(data, _TEXT, consumers or {}, writers or {})
    path = Path(path_or_text)
    try:
        return _parse(contents(path), str(path), consumers or {}, writers or {})
    except OSError as error:
        raise UserError(
            f"{path}: cannot be read ({error.strerror}); give the path of an interface file"
        ) from None


def interface_yaml(interface: Interface) -> str:
    """Return the interface as YAML text; what equals its default is left out."""
    data = interface.model_dump(mode="json", exclude_defaults=True)
    return yaml_text(data, width=100)


def _parse(
    text: bytes, where: str, consumers: Mapping[str, Sequence[str]], writers: Mapping[str, str]
) -> Interface:
    try:
        document = read_yaml(text)
        data = document.data
        if not isinstance(data, dict):
            raise Misread("holds no interface; start with `name:`, `sources:`, `channels:`")
        _complete(cast("dict[str, Any]", data), consumers, writers)
        return document.fill(Interface)
    except Misread as error:
        raise UserError(error.at(where)) from None


def _complete(
    data: dict[str, Any], consumers: Mapping[str, Sequence[str]], writers: Mapping[str, str]
) -> None:
    """Fill in who reads and who reconstructs; what has another shape is left for validation."""
    for channel in _dicts(data, "channels"):
        if "consumers" not in channel and channel.get("name") in consumers:
            channel["consumers"] = list(consumers[channel["name"]])
    made: dict[str, list[str]] = {}
    for source in _dicts(data, "sources"):
        name: str = source["name"]
        if source.get("provenance") == "reconstructed" and name in writers:
            made.setdefault(writers[name], []).append(name)
    if made:
        data.setdefault("reconstructs", made)


def _dicts(data: dict[str, Any], part: str) -> list[dict[str, Any]]:
    items = data.get(part)
    found = cast("list[Any]", items) if isinstance(items, list) else []
    return [
        cast("dict[str, Any]", each)
        for each in found
        if isinstance(each, dict) and isinstance(cast("dict[str, Any]", each).get("name"), str)
    ]
