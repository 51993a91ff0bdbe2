"""The text of a fault, split into its parts; an interface then gives them meaning.

    gain:delay=5                        CHANNEL:KIND=VALUE, at every reader of the channel
    velocity:offset=1/0/0               a vector
    velocity:noise=0.1,relative         more fields of the intervention after commas
    velocity:freeze,onset=20,for=40     when, in control steps; onset_s= and for_s= in seconds
    gain:scale=1.1@observer+controller.inverse   only these modules and places
    PRESET=+0.1                         a fault that the system names
    gain:bias=0.1 & velocity:freeze     faults of one cause; `loading=` correlates what they draw

Further sizes follow after commas, without a name: `gain:scale=0.8,0.9,1.1,onset=20@observer`, or a
range `FROM..TO/COUNT`. The name of a correlation group may stand for its channels.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

from pydantic_core import CoreSchema, core_schema

from faultpath.core.errors import UserError
from faultpath.core.text import number_in

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_SIZE = re.compile(rf"{_NUMBER}(?:/{_NUMBER})*")
_RANGE = re.compile(rf"({_NUMBER})\.\.({_NUMBER})/([0-9]+)")
_MOST_SIZES = 99
"""Sizes of one range; each is an audit."""


@dataclass(frozen=True)
class FaultText:
    """The parts of a fault's text. `faultpath.faults.parse_fault` makes faults of them."""

    text: str
    """The text as written."""
    name: str
    """Name of a channel, a correlation group or a preset."""
    kind: str | None
    """`None` for a preset."""
    sizes: tuple[str, ...]
    options: Mapping[str, str]
    readers: tuple[str, ...]
    """Modules and places; empty for every reader."""
    joined: tuple["FaultText", ...] = ()
    """Faults after each `&`, which share the cause."""

    @classmethod
    def read(cls, text: str) -> Self:
        """Split a text; a range `FROM..TO/COUNT` stands for COUNT sizes, both ends included.

        `UserError` for a text of another form.
        """
        try:
            parts = text.split("&")
            if len(parts) == 1:
                return cls._read(text)
            if not all(part.strip() for part in parts):
                raise UserError("something is missing beside '&'; write a fault on either side")
            first, *others = (cls._read(part.strip()) for part in parts)
            if any(len(part.sizes) > 1 for part in (first, *others)):
                raise UserError("joined faults take one size each; leave further sizes out")
            return replace(first, text=text, joined=tuple(others))
        except UserError as error:
            raise UserError(f"fault '{text}': {error}") from None

    @classmethod
    def _read(cls, text: str) -> Self:
        if not text.strip():
            raise UserError("the text is empty; write CHANNEL:KIND=VALUE or PRESET=SIZE")
        items: list[str] = []
        readers: list[str] = []
        for item in text.split(","):
            head, at, names = (part.strip() for part in item.partition("@"))
            if at and (readers or "@" in names):
                raise UserError("'@' appears twice; join readers with '+', as in @planner+other")
            if at:
                readers = [name.strip() for name in names.split("+")]
                if not all(readers):
                    raise UserError("'@' needs a module or reader after it, as in @planner")
            if not head:
                raise UserError("something is missing between commas; write CHANNEL:KIND=VALUE")
            items.append(head)
        what, has_size, size = items[0].partition("=")
        name, has_kind, kind = what.partition(":")
        sizes = [*_sizes_in(size)] if has_size else []
        options: dict[str, str] = {}
        for item in items[1:]:
            key, equals, value = item.partition("=")
            if not equals and (_SIZE.fullmatch(item) or ".." in item):
                if not has_size:
                    raise UserError(
                        f"{item} is a further size, and there is no first: write "
                        "CHANNEL:KIND=SIZE,SIZE"
                    )
                sizes += _sizes_in(item)
                continue
            if key in options:
                raise UserError(f"option '{key}' appears twice; drop one")
            options[key] = value
        if len({tuple(map(float, s.split("/"))) if _SIZE.fullmatch(s) else s for s in sizes}) < len(
            sizes
        ):
            raise UserError("it names a size twice: name each once")
        named = tuple(dict.fromkeys(readers))
        return cls(text, name, kind if has_kind else None, tuple(sizes), options, named)

    @property
    def cause(self) -> str:
        """Address of the random numbers, without sizes, so that all sizes draw the same."""
        head = self.name if self.kind is None else f"{self.name}:{self.kind}"
        return " & ".join((head, *(part.cause for part in self.joined)))

    def each(self) -> tuple[Self, ...]:
        """Return one fault a size."""
        return tuple(map(self.at, self.sizes)) if len(self.sizes) > 1 else (self,)

    def at(self, size: str) -> Self:
        """Return the same fault of one size."""
        options = (f"{key}={value}" if value else key for key, value in self.options.items())
        readers = f"@{'+'.join(self.readers)}" if self.readers else ""
        text = ",".join((f"{self.cause}={size}", *options)) + readers
        return replace(self, text=text, sizes=(size,))

    def __str__(self) -> str:
        return self.text

    @classmethod
    def __get_pydantic_core_schema__(cls, source: object, handler: object) -> CoreSchema:
        """Read a field of a model from text, and write it word for word."""
        written = core_schema.to_string_ser_schema(when_used="always")
        return core_schema.no_info_plain_validator_function(
            cls._field, serialization=written, json_schema_input_schema=core_schema.str_schema()
        )

    @classmethod
    def _field(cls, value: object) -> Self:
        if isinstance(value, cls):
            return value
        if not isinstance(value, str):
            raise ValueError(f"{value!r:.80} is no text, such as gain:scale=0.6")
        return cls.read(value)


SEVERAL = "a number, or several as 0.01/0"
"""Value that a fault takes where a reading may be a vector."""


def number_of(key: str, text: str, what: str = "a number") -> float:
    """Return the number in a text; `UserError` names the `key` that it belongs to, and `what` it
    needs."""
    try:
        return number_in(text)
    except ValueError as error:
        needs = what if str(error) == "a number" else error
        raise UserError(f"'{key}' needs {needs}, not '{text}'") from None


def _sizes_in(item: str) -> tuple[str, ...]:
    if item.strip()[:1] in ("[", "("):
        raise UserError("several numbers are written with '/' and without brackets, as in 0.01/0")
    match = _RANGE.fullmatch(item)
    if match is None:
        if ".." in item:
            raise UserError(
                "a range cannot be read: write FROM..TO/COUNT, as in gain:scale=0.6..1.2/7"
            )
        return (item,)
    low, high, count = match.groups()
    if len(count) > len(str(_MOST_SIZES)) or not 2 <= int(count) <= _MOST_SIZES:
        raise UserError(f"it asks for {count} sizes: a range takes 2 to {_MOST_SIZES}")
    first, last, steps = number_of("from", low), number_of("to", high), int(count) - 1
    return tuple(f"{(first * (steps - i) + last * i) / steps + 0.0:.10g}" for i in range(steps + 1))
