"""A fault's text taken apart, once: `gain:scale=0.8,0.9,1.1,onset=20@observer+planner`.

What stands between commas is the channel and kind with its sizes, or options; sizes have no name.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

from faultpath.core.errors import UserError

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_SIZE = re.compile(rf"{_NUMBER}(?:/{_NUMBER})*")
_RANGE = re.compile(rf"({_NUMBER})\.\.({_NUMBER})/(\d+)")
_MOST = 99
"""Sizes of one range; each is an audit."""


@dataclass(frozen=True)
class FaultText:
    """The parts of a fault's text, not yet understood."""

    name: str
    """Of a channel, a correlation group or a preset."""
    kind: str | None
    """`None` for a preset."""
    sizes: tuple[str, ...]
    options: Mapping[str, str]
    consumers: tuple[str, ...]

    @classmethod
    def read(cls, text: str) -> Self:
        """Take a text apart; a range `FROM..TO/COUNT` stands for that many sizes, both ends too.

        `UserError` for what has no such form.
        """
        try:
            return cls._read(text)
        except UserError as error:
            raise UserError(f"fault '{text}': {error}") from None

    @classmethod
    def _read(cls, text: str) -> Self:
        if not text.strip():
            raise UserError("the text is empty; write CHANNEL:KIND=VALUE or PRESET=SIZE")
        items: list[str] = []
        consumers: list[str] = []
        for item in text.split(","):
            head, at, names = (part.strip() for part in item.partition("@"))
            if at and (consumers or "@" in names):
                raise UserError("'@' appears twice; join consumers with '+', as in @planner+other")
            if at:
                consumers = [name.strip() for name in names.split("+")]
                if not all(consumers):
                    raise UserError("'@' needs a module or consumer after it, as in @planner")
            if not head:
                raise UserError("something is missing between commas; write CHANNEL:KIND=VALUE")
            items.append(head)
        what, has_size, size = items[0].partition("=")
        name, has_kind, kind = what.partition(":")
        sizes = [*_spread(size)] if has_size else []
        options: dict[str, str] = {}
        for item in items[1:]:
            key, equals, given = item.partition("=")
            if not equals and (_SIZE.fullmatch(item) or ".." in item):
                if not has_size:
                    raise UserError(
                        f"{item} is a further size, and there is no first: write "
                        "CHANNEL:KIND=SIZE,SIZE"
                    )
                sizes += _spread(item)
                continue
            if key in options:
                raise UserError(f"option '{key}' appears twice; drop one")
            options[key] = given
        if len({tuple(map(float, s.split("/"))) if _SIZE.fullmatch(s) else s for s in sizes}) < len(
            sizes
        ):
            raise UserError("it names a size twice: name each once")
        named = tuple(dict.fromkeys(consumers))
        return cls(name, kind if has_kind else None, tuple(sizes), options, named)

    def at(self, size: str) -> Self:
        """Return the same fault of one size."""
        return replace(self, sizes=(size,))

    def __str__(self) -> str:
        head = self.name if self.kind is None else f"{self.name}:{self.kind}"
        sized = f"{head}={','.join(self.sizes)}" if self.sizes else head
        options = (f"{key}={given}" if given else key for key, given in self.options.items())
        at = f"@{'+'.join(self.consumers)}" if self.consumers else ""
        return ",".join((sized, *options)) + at


def each_size(text: str) -> tuple[str, ...]:
    """Return the text of a fault for each of its sizes; a fault of one size is its own only text.

    `UserError` for a text that has no such form.
    """
    asked = FaultText.read(text)
    if len(asked.sizes) < 2:
        return (text,)
    return tuple(str(asked.at(size)) for size in asked.sizes)


def _spread(item: str) -> tuple[str, ...]:
    found = _RANGE.fullmatch(item)
    if found is None:
        if ".." in item:
            raise UserError(
                "a range cannot be read: write FROM..TO/COUNT, as in calibration=-0.2..0.2/9"
            )
        return (item,)
    low, high, count = found.groups()
    if len(count) > len(str(_MOST)) or not 2 <= int(count) <= _MOST:
        raise UserError(f"it asks for {count} sizes: a range takes 2 to {_MOST}")
    first, last, steps = float(low), float(high), int(count) - 1
    return tuple(f"{(first * (steps - i) + last * i) / steps + 0.0:.10g}" for i in range(steps + 1))
