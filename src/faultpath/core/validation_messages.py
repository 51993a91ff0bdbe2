"""Sentences on data that does not fit its model: the field, what is wrong, what is allowed.

Pydantic's own sentences are written for programmers.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast, get_args

from faultpath.core.text import printable, represented, shortened, unknown

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError

_BRANCH = re.compile(r".*[\[(].*|constrained-.*|float|int|str|bool|none|[A-Z]\w*")
"""A step of a location that names a branch of a union and no key: `float`, `literal['fit']`."""
_NUMBER, _WHOLE = "a number", "a whole number"
_KINDS = {
    "string": "text",
    "bytes": "text",
    "int": _WHOLE,
    "finite": "a finite number",
    "bool": "true or false",
    "none": "nothing",
    "path": "a path",
    **dict.fromkeys(("float", "decimal", "complex"), _NUMBER),
    **dict.fromkeys(("tuple", "list", "set", "frozen", "iterable"), "a list"),
    **dict.fromkeys(("dict", "mapping", "model", "dataclass"), "a group of fields, `name: value`"),
}
"""Values allowed, by the first word of a kind of error."""
_WITH = {
    "greater_than": "a number above {gt:g}",
    "greater_than_equal": "a number of at least {ge:g}",
    "less_than": "a number below {lt:g}",
    "less_than_equal": "a number of at most {le:g}",
    "literal_error": "{expected}",
    "enum": "{expected}",
    "is_instance_of": "a {class}",
    "union_tag_invalid": "of the {discriminator} {expected_tags}",
    "string_pattern_mismatch": "text of the form {pattern}",
    "string_too_short": "text of at least {min_length} characters",
    "too_short": "of at least {min_length} values, and has {actual_length}",
    "too_long": "of at most {max_length} values, and has {actual_length}",
}
"""Values allowed, by the kind of error, with the error's own limits."""
_SHOWN = 60


@dataclass(frozen=True)
class Misfit:
    """The first mistake in some data."""

    location: tuple[str | int, ...]
    """Keys and indices on the way to it."""
    message: str
    """The mistake and what is allowed, to follow a colon."""
    names_it: bool = False
    """Whether the words name the location themselves."""

    @property
    def where(self) -> str:
        """Name of the field, `audits[0].name`; empty for all of the data."""
        steps = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in self.location)
        return printable("".join(steps).removeprefix("."))

    def __str__(self) -> str:
        return self.message if self.names_it or not self.where else f"{self.where}: {self.message}"


def misfit_of(error: "ValidationError", model: "type[BaseModel] | None" = None) -> Misfit:
    """Return what is wrong. With the `model`, a sentence on an unknown field lists the known."""
    errors = error.errors(include_url=False)
    first = errors[0]
    if where := first.get("ctx", {}).get("where"):  # a sentence of faultpath's own
        return Misfit(tuple(where), str(first["msg"]), names_it=True)
    if first["type"] == "missing":
        # A misspelt field is missing as well; the word that is there says more.
        parent = first["loc"][:-1]
        extra = (e for e in errors if e["type"] == "extra_forbidden" and e["loc"][:-1] == parent)
        first = next(extra, first)
    location = _location(first)
    same = [e for e in errors if _location(e) == location]
    return Misfit(location, _problem(same, _fields(model, location[:-1])))


def _location(error: Mapping[str, Any]) -> tuple[str | int, ...]:
    steps = cast("tuple[str | int, ...]", error["loc"])
    last = len(steps) - 1 if error["type"] in ("missing", "extra_forbidden") else len(steps)
    return tuple(
        step
        for at, step in enumerate(steps)
        if isinstance(step, int) or at == last or not _BRANCH.fullmatch(step)
    )


def _problem(errors: Sequence[Mapping[str, Any]], known: Sequence[str]) -> str:
    """Return what is wrong at one location, from the errors of all branches of its union."""
    first = errors[0]
    kind, context = str(first["type"]), first.get("ctx", {})
    if kind == "missing":
        return "is missing: add it"
    if kind == "extra_forbidden":
        name = str(first["loc"][-1])
        hint = unknown("field", name, known).removeprefix(f"unknown field '{name}'")
        return f"is no field{hint if known else ''}; correct its spelling or drop it"
    if kind in ("value_error", "assertion_error"):
        return str(context["error"]).rstrip(".") if "error" in context else "does not fit"
    allowed: list[str] = []
    for error in errors:
        kind = str(error["type"])
        values = _KINDS.get(kind.partition("_")[0], "")
        if kind in _WITH:
            values = _WITH[kind].format_map(error.get("ctx", {}))
        allowed += [values] if values and values not in allowed else []
    if {_NUMBER, _WHOLE} <= set(allowed):
        allowed.remove(_WHOLE)
    must = f"and must be {' or '.join(allowed)}" if allowed else "which does not fit"
    return f"is {_shown(first['input'])}, {must}"


def _fields(model: object, location: Sequence[str | int]) -> tuple[str, ...]:
    from pydantic import BaseModel

    if isinstance(model, type) and issubclass(model, BaseModel):
        names = [step for step in location if isinstance(step, str)]
        if not names:
            return tuple(model.model_fields)
        field = model.model_fields.get(names[0])
        return () if field is None else _fields(field.annotation, names[1:])
    return tuple(name for part in get_args(model) for name in _fields(part, location))


def _shown(value: object) -> str:
    if value is None or isinstance(value, bool):
        return {None: "empty", True: "true", False: "false"}[value]
    return shortened(printable(represented(value)), _SHOWN)
