"""Sizes of a fault as a range: `calibration=-0.2..0.2/9` is nine sizes, from -0.2 to 0.2."""

import re

from faultpath.errors import UserError
from faultpath.faults.sizes import each_size as listed_sizes

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_RANGE = re.compile(rf"({_NUMBER})\.\.({_NUMBER})/(\d+)(?=$|[,@])")
_MOST = 99
"""Sizes of one range; each is an audit."""


def each_size(text: str) -> tuple[str, ...]:
    """Return the text of a fault for each of its sizes, listed or in a range, in their order.

    A range `FROM..TO/COUNT` stands for that many sizes at equal distances, both ends among them.
    `UserError` for a range that is none, and as for a list.
    """
    spread = _RANGE.sub(lambda found: _spread(text, *found.groups()), text)
    if ".." in spread:
        raise UserError(
            f"fault '{text}' has a range that cannot be read: write FROM..TO/COUNT, as in "
            "calibration=-0.2..0.2/9"
        )
    return listed_sizes(spread)


def _spread(text: str, low: str, high: str, count: str) -> str:
    if len(count) > len(str(_MOST)) or not 2 <= int(count) <= _MOST:
        raise UserError(f"fault '{text}' asks for {count} sizes: a range takes 2 to {_MOST}")
    first, last, steps = float(low), float(high), int(count) - 1
    return ",".join(
        f"{(first * (steps - i) + last * i) / steps + 0.0:.10g}" for i in range(steps + 1)
    )
