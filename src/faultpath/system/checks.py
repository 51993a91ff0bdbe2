"""Checks of a user's system before a run, so that nothing fails halfway."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from numbers import Integral, Real
from os import PathLike
from typing import Any, cast

from faultpath.core.error_source import described, location
from faultpath.core.errors import SystemMistake, UserError
from faultpath.interface import Interface
from faultpath.loop.tap import wire
from faultpath.system.declared import Library, Variant, check_name, shown
from faultpath.system.outcome import Metric, Outcome, Status
from faultpath.system.system import System

UNNAMED = ("held-out", "selection")
"""Libraries that audits and checks run by default."""

_COLUMNS = frozenset(
    {"variant", "condition", "seed", "scene", "scene_index", "topology", "x_m", "y_m", "z_m"}
    | {f.name for f in fields(Outcome)}
)
"""Columns of the table of outcomes, which a metric cannot have as its name."""


def library_of(system: System, name: str) -> Library:
    """Return a library of a system; `SystemMistake` for another object, `UserError` for a name.

    A system may return its only library for each of the default names.
    """
    library: Any = system.library(name)
    if not isinstance(library, Library):
        raise SystemMistake(
            f"system '{system.name}': `library` returned {shown(library)}: it must return a Library"
        )
    if name not in UNNAMED and library.name != name:
        raise SystemMistake(
            f"system '{system.name}' gave library '{library.name}' for '{name}': ask for it by its "
            "own name, and let `library` raise UserError for any other"
        )
    return library


def paths_of(system: System, attribute: str) -> tuple[str | PathLike[str], ...]:
    """Return the paths in an attribute of the system; `SystemMistake` for anything else."""
    paths = _declared(system, attribute, f"system {system.name!r}")
    if not isinstance(paths, (str, bytes, PathLike)) and isinstance(paths, Iterable):
        listed = tuple(cast("Iterable[Any]", paths))
        if all(isinstance(path, (str, PathLike)) for path in listed):
            return listed
    raise SystemMistake(
        f"system {system.name!r}: `{attribute}` is {shown(paths)}: give paths, as a tuple"
    )


def _positive(number: Any) -> bool:
    return isinstance(number, Real) and 0 < float(number) < float("inf")


def _mapping(is_valid: Callable[[Any, Any], bool], minimum: int = 0) -> Callable[[Any], bool]:
    return lambda mapping: (
        isinstance(mapping, Mapping)
        and len(cast("Any", mapping)) >= minimum
        and all(is_valid(key, value) for key, value in cast("Mapping[Any, Any]", mapping).items())
    )


_REQUIRED: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "control_dt_s": (_positive, "give the seconds of a control step"),
    "block_size": (
        lambda size: size is None or (isinstance(size, Integral) and int(size) >= 1),
        "give a whole number, 1 or more, or None",
    ),
    "parallel": (lambda flag: isinstance(flag, int), "give True or False"),
    "trained": (lambda flag: isinstance(flag, int), "give True or False"),
    "time_limit_s": (lambda limit: limit is None or _positive(limit), "give seconds, or None"),
    "interface": (
        lambda interface: isinstance(interface, Interface),
        "give what `read_interface` returns",
    ),
    "metrics": (
        _mapping(lambda name, metric: isinstance(name, str) and isinstance(metric, Metric)),
        "map names to Metrics",
    ),
    "ends": (
        _mapping(lambda key, words: isinstance(key, Status) and isinstance(words, str)),
        "map a Status to what it is called",
    ),
    "fault_presets": (
        _mapping(lambda key, preset: isinstance(key, str) and callable(preset)),
        "map names to functions that return a tuple of Faults",
    ),
    "variants": (
        _mapping(lambda key, variant: isinstance(variant, Variant) and variant.name == key, 1),
        "map the name of each Variant to it",
    ),
}
"""Attributes that an audit reads of every system, each with a condition and advice if it fails."""


def check_system(system: System, name: str) -> None:
    """Raise `SystemMistake` unless `system` declares what every audit needs.

    `name` is the name by which the user called it.
    """
    label = f"system {name!r}"
    check_name(f"{label}: `name`", _declared(system, "name", label))
    values: dict[str, Any] = {}
    for attribute, (is_valid, advice) in _REQUIRED.items():
        values[attribute] = _declared(system, attribute, label)
        if not is_valid(values[attribute]):
            raise SystemMistake(f"{label}: `{attribute}` is {shown(values[attribute])}: {advice}")
    for metric in values["metrics"]:
        if metric in _COLUMNS:
            raise SystemMistake(f"{label}: metric '{metric}' is a column of the table: rename it")
        wrong = re.sub(r"^[a-z][a-z0-9_]*", "", metric)
        if wrong or not metric:
            where = f"has {wrong[0]!r} in its name" if wrong else "has no name"
            raise SystemMistake(
                f"{label}: metric '{metric}' {where}: use small letters, digits and '_', a letter "
                "first"
            )
    for key, variant in values["variants"].items():
        try:
            wire(values["interface"], variant.bindings, variant.readers, variant.privileged, 0)
        except UserError as error:
            raise SystemMistake(f"{label}: variant '{key}': {error}") from None


def _declared(system: System, attribute: str, label: str) -> Any:
    try:
        value = getattr(system, attribute)
    except (Exception, SystemExit) as error:
        # An AttributeError without such an attribute in the class is no failed property.
        if not isinstance(error, AttributeError) or hasattr(type(system), attribute):
            ours = isinstance(error, UserError)
            reason = str(error) if ours else f"`{attribute}` fails ({described(error)})"
            mistake = SystemMistake(f"{label}: {reason}")
            mistake.location = location(error)
            raise mistake from error
        value = None
    may_be_none = attribute == "block_size"  # then it follows from the size of the library
    if value is None and not may_be_none and getattr(System, attribute, attribute) is not None:
        raise SystemMistake(f"{label} declares no `{attribute}`: set it in the class")
    return value
