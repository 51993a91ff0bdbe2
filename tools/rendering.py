"""Templates of blocks: a macro `a_b` of a file in `templates` writes the blocks of kind `a:b`."""

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from faultpath.core.text import counted, series
from faultpath.report.escapes import markdown as escape
from faultpath.report.sentences import wording
from faultpath.report.tables import MISSING

TEMPLATES = Path(__file__).parent / "templates"


def row(cells: Iterable[object]) -> str:
    """Return a line of a table from cells that are Markdown already."""
    first, *rest = map(str, cells)
    return f"| {f'{first} ' if first else ''}| {' | '.join(rest)} |"


def head(columns: Sequence[str], words: Collection[int] | None = None) -> str:
    """Return the first two lines of a table; columns of `words`, or all, stand to the left."""
    left = range(len(columns)) if words is None else words
    sides = (":--" if index in left else "--:" for index in range(len(columns)))
    return f"{row(columns)}\n{row(sides)}"


def difference(value: float, low: float, high: float, *, bold: bool) -> str:
    """Return a difference with its interval, in Markdown."""
    text = wording.signed(value, 1)
    ends = ", ".join(wording.signed(end, 1) for end in (low, high))
    return f"{f'**{text}**' if bold else text} [{ends}]"


def effect(numbers: Sequence[float]) -> str:
    """Return a difference of a study: value, both ends, and the sign if significant, then bold."""
    *numbers, sign = numbers
    text = escape(difference(*numbers, bold=False))
    return f"**{text}**" if sign else text


def mean(of: Any) -> str:
    """Return a mean over cells, bold where it is significant; a dash where there is none."""
    if of is None:
        return MISSING
    ends = ", ".join(wording.plain(end) for end in (of.low_pp, of.high_pp))
    text = escape(f"{wording.signed(of.value_pp)} [{ends}]")
    return f"**{text}**" if of.sign else text


def percent(share: float, digits: int = 1) -> str:
    """Return a share in percent."""
    return wording.plain(100 * share, digits)


def fence(body: str, info: str = "text", *more: str) -> str:
    """Return a fenced block."""
    return f"```{' '.join([info, *more])}\n{body}\n```"


FILTERS: Mapping[str, Callable[..., object]] = {
    "at": lambda key, mapping: mapping[key],
    "counted": counted,
    "counted_in": lambda word, words: words.count(word) or "",
    "effect": effect,
    "escape": escape,
    "fence": fence,
    "get": lambda mapping, key: mapping.get(key),
    "joined": lambda text: re.sub(r"\s*\n\s*", " ", text.strip()),
    "mean": mean,
    "percent": percent,
    "plain": wording.plain,
    "seeds": wording.seeds,
    "series": series,
    "signed": wording.signed,
}


def macros(
    names: Mapping[str, Any], filters: Mapping[str, Callable[..., object]]
) -> dict[str, Callable[..., str]]:
    """Return what writes a block, by its kind; templates may use `names` and `filters`."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        autoescape=False,  # Markdown: templates escape what is not ours
    )
    environment.filters.update(FILTERS, **filters)
    environment.globals.update(names, MISSING=MISSING, head=head, row=row)
    kinds: dict[str, Callable[..., str]] = {}
    for file in environment.list_templates(extensions=["j2"]):
        for name, macro in vars(environment.get_template(file).module).items():
            if callable(macro) and not name.startswith("_"):
                kinds[name.replace("_", ":", 1)] = _stripped(macro)
    return kinds


def _stripped(macro: Callable[..., object]) -> Callable[..., str]:
    return lambda *words: str(macro(*words)).removesuffix("\n")
