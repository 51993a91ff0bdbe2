"""Interfaces as YAML: read with the safe loader only, written so that reading gives the same."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import yaml
from pydantic import ValidationError
from yaml.events import AliasEvent, CollectionEndEvent, CollectionStartEvent
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from faultpath.errors import UserError
from faultpath.interface.checks import Interface
from faultpath.misfits import misfit_of

_DEEPEST = 12
_LONGEST = 1_000_000
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
        return _parse(path_or_text, _TEXT, consumers or {}, writers or {})
    path = Path(path_or_text)
    try:
        text = _read(path).decode("utf-8")
    except OSError as error:
        raise UserError(
            f"{path}: cannot be read ({error.strerror}); give the path of an interface file"
        ) from None
    except UnicodeDecodeError:
        raise UserError(f"{path}: is not UTF-8 text; save the interface as UTF-8") from None
    except ValueError:  # a name with NUL or a surrogate in it
        raise UserError(f"{path}: is not a file name; give the path of a file") from None
    return _parse(text, str(path), consumers or {}, writers or {})


def interface_yaml(interface: Interface) -> str:
    """Return the interface as YAML text; what equals its default is left out."""
    data = interface.model_dump(mode="json", exclude_defaults=True)
    return yaml.safe_dump(data, sort_keys=False, allow_unicode=True, width=100)


def _read(path: Path) -> bytes:
    """Read a file, but no device or pipe: those may have no end."""
    if path.exists() and not path.is_file():
        raise OSError(0, "it is not a file")
    with path.open("rb") as file:
        return file.read(_LONGEST + 1)


def _parse(
    text: str, where: str, consumers: Mapping[str, Sequence[str]], writers: Mapping[str, str]
) -> Interface:
    if len(text) > _LONGEST:
        raise UserError(f"{where}: is too long; an interface has at most {_LONGEST} characters")
    root = _compose(text, where)
    if not isinstance(root, MappingNode):
        raise UserError(f"{where}: holds no interface; start with `name:`, `sources:`, `channels:`")
    for line, key in _repeated_keys(root):
        raise UserError(f"{where}, line {line}: key '{key}' appears twice; drop one")
    try:
        return Interface.model_validate(_completed(yaml.safe_load(text), consumers, writers))
    except yaml.YAMLError as error:
        raise _not_yaml(error, where) from None
    except ValidationError as error:
        raise _refused(error, root, where) from None
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        # a number of 5,000 digits, the 99th of a month, `!!bool 7`: the loader lets them through
        raise UserError(f"{where}: holds an invalid value ({error}); write it plainly") from None


def _completed(
    data: Any, consumers: Mapping[str, Sequence[str]], writers: Mapping[str, str]
) -> Any:
    """Fill in who reads and who reconstructs; what has another shape is left for validation."""
    for channel in _dicts(data, "channels"):
        if "consumers" not in channel and channel.get("name") in consumers:
            channel["consumers"] = list(consumers[channel["name"]])
    made: dict[str, list[str]] = {}
    for source in _dicts(data, "sources"):
        name: str = source["name"]
        if source.get("provenance") == "reconstructed" and name in writers:
            made.setdefault(writers[name], []).append(name)
    if made:  # so it is a mapping
        data.setdefault("reconstructs", made)
    return data


def _dicts(data: Any, part: str) -> list[dict[str, Any]]:
    items = cast("dict[str, Any]", data).get(part) if isinstance(data, dict) else None
    found = cast("list[Any]", items) if isinstance(items, list) else []
    return [
        cast("dict[str, Any]", each)
        for each in found
        if isinstance(each, dict) and isinstance(cast("dict[str, Any]", each).get("name"), str)
    ]


def _compose(text: str, where: str) -> Node | None:
    try:
        _check_events(cast(Any, yaml).parse(text, Loader=yaml.SafeLoader), where)
        return cast(Any, yaml).compose(text, Loader=yaml.SafeLoader)
    except yaml.YAMLError as error:
        raise _not_yaml(error, where) from None


def _check_events(events: Iterator[Any], where: str) -> None:
    """Refuse what makes a short file expensive to read: aliases of aliases and deep nesting."""
    depth = 0
    for event in events:
        place = f"{where}, line {event.start_mark.line + 1}"
        depth += isinstance(event, CollectionStartEvent) - isinstance(event, CollectionEndEvent)
        if depth > _DEEPEST:
            raise UserError(f"{place}: is nested too deeply; an interface has few levels")
        if isinstance(event, AliasEvent):
            raise UserError(f"{place}: aliases are not read; write it out")


def _not_yaml(error: yaml.YAMLError, where: str) -> UserError:
    if isinstance(error, yaml.MarkedYAMLError) and error.problem_mark is not None:
        where = f"{where}, line {error.problem_mark.line + 1}"
        problem = " ".join(filter(None, (error.context, error.problem)))
    else:
        problem = " ".join(str(error).split())
    return UserError(f"{where}: is not plain YAML ({problem}); correct it or drop the tag")


def _items(node: Node) -> Iterator[tuple[Any, Node, Node]]:
    """Yield `(key, node that shows the place, value node)` of a mapping or a sequence."""
    if isinstance(node, MappingNode):
        for key, value in cast(list[tuple[Node, Node]], node.value):
            yield (key.value if isinstance(key, ScalarNode) else None), key, value
    elif isinstance(node, SequenceNode):
        for index, value in enumerate(cast(list[Node], node.value)):
            yield index, value, value


def _repeated_keys(node: Node) -> Iterator[tuple[int, str]]:
    seen: set[Any] = set()
    for key, shown, value in _items(node):
        if key in seen:
            yield shown.start_mark.line + 1, str(key)
        seen.add(key)
        yield from _repeated_keys(value)


def _line(root: Node, path: Sequence[str | int]) -> int:
    """Return the line of the deepest part of `path` that the file has, counted from one."""
    node, line = root, root.start_mark.line + 1
    for part in path:
        for key, shown, value in _items(node):
            if key == part:
                node, line = value, shown.start_mark.line + 1
                break
        else:
            break
    return line


def _refused(error: ValidationError, root: Node, where: str) -> UserError:
    found = misfit_of(error, Interface)
    tail = f" ({found.more} more to correct after it)" if found.more else ""
    return UserError(f"{where}, line {_line(root, found.place)}: {found}{tail}")
