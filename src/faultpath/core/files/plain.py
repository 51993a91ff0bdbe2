"""Strict readers of YAML and JSON, so that no two programs read a file differently.

Numbers are those of JSON, finite and in ASCII. Keys are text and unique. Aliases and tags, by which
a short file could grow without end, are refused.
"""

import json
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NoReturn, TypeVar, cast

import yaml
from pydantic import BaseModel, ValidationError
from yaml.events import AliasEvent, CollectionEndEvent, CollectionStartEvent, NodeEvent
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from faultpath.core.errors import UserError
from faultpath.core.text import number_in, whole_in
from faultpath.core.validation_messages import misfit_of

LONGEST = 1_000_000
"""Bytes of a YAML file."""
_DEEPEST = 12
_TOO_DEEP = "is nested too deeply; a file of this kind has few levels"
_TYPE = "tag:yaml.org,2002:"
_Safe: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # four times as fast in C
_Model = TypeVar("_Model", bound=BaseModel)
_Number = TypeVar("_Number", int, float)


class Misread(ValueError):
    """Data that cannot be read; the message follows a colon. `line`, where it is known."""

    def __init__(self, message: str, line: int | None = None) -> None:
        super().__init__(message)
        self.line = line

    def at(self, where: object) -> str:
        """Return the message with `where`, and the line, in front."""
        return f"{where}: {self}" if self.line is None else f"{where}, line {self.line}: {self}"


def text_of(data: bytes) -> str:
    """Return UTF-8 text; `Misread` for anything else."""
    try:
        text = data.decode("utf-8-sig")  # with the byte order mark that spreadsheets write, or not
    except UnicodeDecodeError:
        raise Misread("is not UTF-8 text; save it as UTF-8") from None
    if "\0" in text:
        raise Misread(
            "holds a null character, and is no text", text[: text.index("\0")].count("\n") + 1
        )
    return text


def read_json(data: bytes) -> Any:
    """Return the value in a JSON file; `Misread` for anything that is not strictly JSON."""

    def no_number(text: str) -> NoReturn:
        raise Misread(f"holds {text}, which is no number of JSON")

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        entries: dict[str, Any] = {}
        for key, value in pairs:
            if key in entries:
                raise Misread(f"key '{key}' appears twice; drop one")
            entries[key] = value
        return entries

    try:
        return json.loads(
            text_of(data),
            parse_constant=no_number,
            parse_int=_whole,
            parse_float=_fraction,
            object_pairs_hook=once,
        )
    except json.JSONDecodeError as error:
        raise Misread(f"is not JSON ({error.msg})", error.lineno) from None
    except RecursionError:
        raise Misread("is nested too deeply") from None


def model_of(data: bytes, model: type[_Model]) -> _Model:
    """Return a model from JSON that faultpath wrote; `Misread` where it does not fit."""
    read_json(data)
    try:
        return model.model_validate_json(data)
    except ValidationError as error:
        raise Misread(str(misfit_of(error))) from None
    except UserError as error:  # of a text in it, such as a fault's
        raise Misread(str(error)) from None


@dataclass(frozen=True)
class Document:
    """Values of a YAML file, and their lines."""

    data: Any
    """Values of the types of JSON."""
    _root: Node | None

    def line(self, path: Sequence[str | int]) -> int:
        """Return the line of the deepest part of `path` that the file has, counted from one."""
        node = self._root
        line = 1 if node is None else node.start_mark.line + 1
        for part in path:
            for key, shown, value in _items(node):
                if key == part:
                    node, line = value, shown.start_mark.line + 1
                    break
            else:
                break
        return line

    def fill(self, model: type[_Model]) -> _Model:
        """Return the data as a model; `Misread` where it does not fit."""
        try:
            return model.model_validate_json(json.dumps(self.data), strict=True)
        except ValidationError as error:
            misfit = misfit_of(error, model)
            raise Misread(str(misfit), self.line(misfit.location)) from None


def read_yaml(data: bytes) -> Document:
    """Return the values in a YAML file; `Misread` for anything that is not plain YAML."""
    if len(data) > LONGEST:
        raise Misread(f"is too long; at most {LONGEST} bytes are read")
    text = text_of(data)
    try:
        _check_events(cast(Any, yaml).parse(text, Loader=_Loader))
        loader = _Loader(text)
        root: Node | None = loader.get_single_node()
        return Document(None if root is None else loader.construct_document(root), root)
    except yaml.MarkedYAMLError as error:
        problem = " ".join(" ".join(filter(None, (error.context, error.problem))).split())
        line = None if error.problem_mark is None else error.problem_mark.line + 1
        if "nesting depth" in problem:  # newer parsers keep a limit of their own
            raise Misread(_TOO_DEEP, line) from None
        raise Misread(f"is not plain YAML ({problem}); correct it", line) from None
    except yaml.YAMLError as error:
        problem = " ".join(str(error).split())
        raise Misread(f"is not plain YAML ({problem}); correct it") from None


class _Loader(_Safe):
    """Reads text, numbers and truth values and nothing else; keys are text and unique."""

    yaml_implicit_resolvers: ClassVar[dict[str, Any]] = {}

    def construct_mapping(self, node: MappingNode, deep: bool = False) -> dict[str, Any]:
        """Return a mapping; `Misread` for a key that is no text or appears twice."""
        seen: set[str] = set()
        for key, _ in cast(list[tuple[Node, Node]], node.value):
            line = key.start_mark.line + 1
            if not isinstance(key, ScalarNode):
                raise Misread("a key is no text; write a word before the colon", line)
            if key.value in seen:
                raise Misread(f"key '{key.value}' appears twice; drop one", line)
            seen.add(key.value)
            key.tag = _TYPE + "str"
        return _Safe.construct_mapping(self, node, deep)

    def number(self, node: ScalarNode) -> float:
        """Return a number; `Misread` for one out of range."""
        try:
            return (_whole if node.tag == _TYPE + "int" else _fraction)(node.value)
        except Misread as error:
            raise Misread(str(error), node.start_mark.line + 1) from None


for _kind in ("int", "float"):
    _Loader.add_constructor(_TYPE + _kind, _Loader.number)


_INTEGER = re.compile(r"[-+]?(?:0|[1-9][0-9]*)$")
_NUMBER = re.compile(
    r"[-+]?(?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eE]))(?:[eE][-+]?[0-9]+)?$"
    r"|[-+]?\.(?:inf|Inf|INF)$|\.(?:nan|NaN|NAN)$"
)
_TRUTH = re.compile(
    r"(?:yes|Yes|YES|no|No|NO|true|True|TRUE|false|False|FALSE|on|On|ON|off|Off|OFF)$"
)
_NOTHING = re.compile(r"(?:~|null|Null|NULL|)$")
for _name, _pattern, _first in (
    ("null", _NOTHING, ["~", "n", "N", ""]),
    ("bool", _TRUTH, list("yYnNtTfFoO")),
    ("int", _INTEGER, list("-+0123456789")),
    ("float", _NUMBER, list("-+.0123456789")),
):
    _Loader.add_implicit_resolver(_TYPE + _name, _pattern, _first)


def _check_events(events: Iterator[Any]) -> None:
    """Refuse what would make a short file expensive, before any value is built."""
    depth = 0
    for event in events:
        line = event.start_mark.line + 1
        depth += isinstance(event, CollectionStartEvent) - isinstance(event, CollectionEndEvent)
        if depth > _DEEPEST:
            raise Misread(_TOO_DEEP, line)
        if isinstance(event, AliasEvent):
            raise Misread("aliases are not read; write it out", line)
        if isinstance(event, NodeEvent) and (tag := getattr(event, "tag", None)) is not None:
            raise Misread(f"tags are not read; drop '{tag.replace(_TYPE, '!!')}'", line)


def _whole(text: str) -> int:
    return _read(whole_in, text, text)


def _fraction(text: str) -> float:
    return _read(number_in, text.lower().replace(".inf", "inf").replace(".nan", "nan"), text)


def _read(read: Callable[[str], _Number], plain: str, text: str) -> _Number:
    try:
        return read(plain)
    except ValueError as error:
        short = text if len(text) <= 40 else f"{text[:20]}… of {len(text)} characters"
        raise Misread(f"the number {short} is out of range; write {error}") from None


def _items(node: Node | None) -> Iterator[tuple[Any, Node, Node]]:
    if isinstance(node, MappingNode):
        for key, value in cast(list[tuple[Node, Node]], node.value):
            yield (key.value if isinstance(key, ScalarNode) else None), key, value
    elif isinstance(node, SequenceNode):
        for index, value in enumerate(cast(list[Node], node.value)):
            yield index, value, value
