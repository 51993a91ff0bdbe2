"""What does not fit a model of data, in words: the field, what is wrong, what is allowed.

Pydantic's own sentences are written for programmers; whatever tells a user of one asks here.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast, get_args

from faultpath.text import printable, unknown

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError

_BRANCH = re.compile(r".*[\[(].*|constrained-.*|float|int|str|bool|none|[A-Z]\w*")
"""What stands in a place for a branch that was tried and is no key: `float`, `literal['fit']`."""
_NUMBERS = "a number"
_WHOLE = "a whole number"
_LIST = "a list"
_FIELDS = "a group of fields, `name: value`"
_KINDS = {
    "string": "text",
    "int": _WHOLE,
    "float": _NUMBERS,
    "decimal": _NUMBERS,
    "complex": _NUMBERS,
    "finite": "a finite number",
    "bool": "true or false",
    "tuple": _LIST,
    "list": _LIST,
    "set": _LIST,
    "frozen": _LIST,
    "iterable": _LIST,
    "dict": _FIELDS,
    "mapping": _FIELDS,
    "model": _FIELDS,
    "dataclass": _FIELDS,
    "none": "nothing",
    "path": "a path",
    "bytes": "text",
}
"""What is allowed, by the first word of a kind of error."""
_BOUNDS = {
    "greater_than": ("gt", "above"),
    "greater_than_equal": ("ge", "of at least"),
    "less_than": ("lt", "below"),
    "less_than_equal": ("le", "of at most"),
    "multiple_of": ("multiple_of", "that is a multiple of"),
}
_LENGTHS = {"too_short": "min_length", "too_long": "max_length"}
_SHOWN = 60


@dataclass(frozen=True)
class Misfit:
    """What is wrong first, and how much more there is."""

    place: tuple[str | int, ...]
    """Keys and indices that lead to it."""
    says: str
    """In words that follow a colon; what is allowed is among them."""
    more: int = 0
    """How many other places are wrong too."""
    names_it: bool = False
    """Whether the words name the place themselves."""

    @property
    def where(self) -> str:
        """The field: `audits[0].name`; empty for the whole."""
        steps = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in self.place)
        return printable("".join(steps).removeprefix("."))

    def __str__(self) -> str:
        return self.says if self.names_it or not self.where else f"{self.where}: {self.says}"


def misfit_of(error: "ValidationError", model: "type[BaseModel] | None" = None) -> Misfit:
    """Return what is wrong in words. With the `model`, an unknown field comes with the known."""
    found = error.errors(include_url=False)
    first = found[0]
    if where := first.get("ctx", {}).get("where"):  # a sentence of faultpath's own
        return Misfit(tuple(where), str(first["msg"]), len(found) - 1, names_it=True)
    if first["type"] == "missing":
        beside = first["loc"][:-1]
        if isinstance(first["loc"][-1], int):
            return _short_list(found, _place(first)[:-1])
        # What is misspelt is missing as well; the word that stands there says more.
        strange = (e for e in found if e["type"] == "extra_forbidden" and e["loc"][:-1] == beside)
        first = next(strange, first)
    place = _place(first)
    same = [each for each in found if _place(each) == place]
    rest = {_place(each) for each in found} - {place}
    return Misfit(place, _said(same, _fields(model, place[:-1])), len(rest))


def _place(error: Mapping[str, Any]) -> tuple[str | int, ...]:
    steps = cast("tuple[str | int, ...]", error["loc"])
    last = len(steps) - 1 if error["type"] in ("missing", "extra_forbidden") else len(steps)
    return tuple(
        step
        for at, step in enumerate(steps)
        if isinstance(step, int) or at == last or not _BRANCH.fullmatch(step)
    )


def _short_list(found: Sequence[Mapping[str, Any]], place: tuple[str | int, ...]) -> Misfit:
    missing = [p[-1] for each in found if (p := _place(each))[:-1] == place and p != place]
    at = [index for index in missing if isinstance(index, int)]
    says = f"has {_counted(min(at))}, and {max(at) + 1} belong there: add what is missing"
    rest = {_place(each) for each in found if _place(each)[:-1] != place}
    return Misfit(place, says, len(rest))


def _said(errors: Sequence[Mapping[str, Any]], known: Sequence[str]) -> str:
    """Say what is wrong at one place: `errors` are of the branches that were tried."""
    first = errors[0]
    kind, context, given = str(first["type"]), first.get("ctx", {}), first["input"]
    match kind:
        case "missing":
            return "is missing: add it"
        case "extra_forbidden":
            name = str(first["loc"][-1])
            told = unknown("field", name, known).removeprefix(f"unknown field '{name}'")
            return f"is no field{told if known else ''}; correct its spelling or drop it"
        case "value_error" | "assertion_error":
            return str(context["error"]).rstrip(".") if "error" in context else "does not fit"
        case "json_invalid":
            return f"is not JSON ({context.get('error', 'damaged')})"
        case "too_short" | "too_long":
            least = "at least" if kind == "too_short" else "at most"
            count = int(context[_LENGTHS[kind]])
            return f"has {_counted(int(context['actual_length']))}, and takes {least} {count}"
        case _:
            pass
    allowed = [said for said in dict.fromkeys(map(_allowed, errors)) if said]
    if {_NUMBERS, _WHOLE} <= set(allowed):
        allowed.remove(_WHOLE)
    must = f"and must be {' or '.join(allowed)}" if allowed else "which does not fit"
    return f"is {_shown(given)}, {must}"


def _allowed(error: Mapping[str, Any]) -> str:
    kind, context = str(error["type"]), error.get("ctx", {})
    if kind in _BOUNDS:
        key, said = _BOUNDS[kind]
        return f"{_NUMBERS} {said} {context[key]:g}"
    match kind:
        case "literal_error" | "enum":
            return str(context["expected"])
        case "union_tag_invalid":
            return f"of the {context['discriminator']} {context['expected_tags']}"
        case "union_tag_not_found":
            return f"fields with a {context['discriminator']} among them"
        case "string_pattern_mismatch":
            return f"text of the form {str(context['pattern']).strip('^$')}"
        case "string_too_short":
            return f"text of at least {context['min_length']} characters"
        case "string_too_long":
            return f"text of at most {context['max_length']} characters"
        case "is_instance_of":
            return f"a {context['class']}"
        case _:
            return _KINDS.get(kind.partition("_")[0], "")


def _fields(model: object, place: Sequence[str | int]) -> tuple[str, ...]:
    from pydantic import BaseModel

    if isinstance(model, type) and issubclass(model, BaseModel):
        names = [step for step in place if isinstance(step, str)]
        if not names:
            return tuple(model.model_fields)
        field = model.model_fields.get(names[0])
        return () if field is None else _fields(field.annotation, names[1:])
    return tuple(name for part in get_args(model) for name in _fields(part, place))


def _counted(count: int) -> str:
    return f"{count} value{'s' * (count != 1)}"


def _shown(given: object) -> str:
    if given is None or isinstance(given, bool):
        return {None: "empty", True: "true", False: "false"}[given]
    try:
        text = printable(repr(given))
    except Exception:  # whatever a system's own object does when it is printed
        return f"a {type(given).__name__}"
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 1]}…"
