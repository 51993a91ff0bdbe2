"""What a user's system must be like, so that nothing fails halfway for want of it."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from numbers import Integral, Real
from os import PathLike
from typing import Any, cast

from faultpath.core.error_source import described, place
from faultpath.core.errors import SystemMistake, UserError
from faultpath.interface import Interface
from faultpath.loop.tap import wire
from faultpath.trials.declared import Library, Variant, check_name, shown
from faultpath.trials.outcome import Metric, Outcome, Status
from faultpath.trials.system import System

UNNAMED = ("held-out", "selection")
"""What audits and checks ask for where no library is named."""

_COLUMNS = frozenset(
    {"variant", "path", "seed", "scene", "scene_index", "topology", "x_m", "y_m", "z_m"}
    | {f.name for f in fields(Outcome)}
)
"""Names that the table of outcomes has already."""


def library_of(system: System, name: str) -> Library:
    """Return a library of a system; `SystemMistake` for what is none, `UserError` for no name.

    A system may have its one library under the names that stand for one where none is given.
    """
    found: Any = system.library(name)
    if not isinstance(found, Library):
        raise SystemMistake(
            f"system '{system.name}': `library` returned {shown(found)}: it must return a Library"
        )
    if name not in UNNAMED and found.name != name:
        raise SystemMistake(
            f"system '{system.name}' gave library '{found.name}' for '{name}': ask for it by its "
            "own name, and let `library` raise UserError for any other"
        )
    return found


def paths_of(system: System, attribute: str) -> tuple[str | PathLike[str], ...]:
    """Return paths that the system names; `SystemMistake` for what are none."""
    found = _declared(system, attribute, f"system {system.name!r}")
    if not isinstance(found, (str, bytes, PathLike)) and isinstance(found, Iterable):
        several = tuple(cast("Iterable[Any]", found))
        if all(isinstance(each, (str, PathLike)) for each in several):
            return several
    raise SystemMistake(
        f"system {system.name!r}: `{attribute}` is {shown(found)}: give paths, as a tuple"
    )


def _positive(found: Any) -> bool:
    return isinstance(found, Real) and 0 < float(found) < float("inf")


def _mapping(holds: Callable[[Any, Any], bool], least: int = 0) -> Callable[[Any], bool]:
    return lambda found: (
        isinstance(found, Mapping)
        and len(cast("Any", found)) >= least
        and all(holds(key, value) for key, value in cast("Mapping[Any, Any]", found).items())
    )


_PROMISED: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "control_dt_s": (_positive, "give the seconds of a control step"),
    "block_size": (
        lambda found: isinstance(found, Integral) and int(found) >= 1,
        "give a whole number, 1 or more",
    ),
    "parallel": (lambda found: isinstance(found, int), "give True or False"),
    "trained": (lambda found: isinstance(found, int), "give True or False"),
    "time_limit_s": (lambda found: found is None or _positive(found), "give seconds, or None"),
    "interface": (
        lambda found: isinstance(found, Interface),
        "give what `read_interface` returns",
    ),
    "metrics": (
        _mapping(
            lambda name, metric: (
                isinstance(metric, Metric)
                and re.fullmatch(r"[a-z][a-z0-9_]*", str(name)) is not None
                and name not in _COLUMNS
            )
        ),
        "map names to Metrics; a name has small letters, digits and '_', and is none that the "
        "table of outcomes has already",
    ),
    "ends": (
        _mapping(lambda key, words: isinstance(key, Status) and isinstance(words, str)),
        "map a Status to what it is called",
    ),
    "fault_presets": (
        _mapping(lambda key, preset: isinstance(key, str) and callable(preset)),
        "map names to functions that return a fault",
    ),
    "variants": (
        _mapping(lambda key, variant: isinstance(variant, Variant) and variant.name == key, 1),
        "map the name of each Variant to it",
    ),
}
"""What an audit reads of every system, what must hold of it, and what to do where it does not."""


def check_system(system: System, name: str) -> None:
    """Raise `SystemMistake` unless `system` declares what every audit asks of it.

    `name` is what the user calls it by.
    """
    said = f"system {name!r}"
    check_name(f"{said}: `name`", _declared(system, "name", said))
    found: dict[str, Any] = {}
    for attribute, (holds, wanted) in _PROMISED.items():
        found[attribute] = _declared(system, attribute, said)
        if not holds(found[attribute]):
            raise SystemMistake(f"{said}: `{attribute}` is {shown(found[attribute])}: {wanted}")
    for key, variant in found["variants"].items():
        try:
            wire(found["interface"], variant.bindings, variant.consumers, variant.privileged, 0)
        except UserError as error:
            raise SystemMistake(f"{said}: variant '{key}': {error}") from None


def _declared(system: System, attribute: str, said: str) -> Any:
    try:
        found = getattr(system, attribute)
    except (Exception, SystemExit) as error:
        # Without the attribute in its class there is no property that could fail.
        if not isinstance(error, AttributeError) or hasattr(type(system), attribute):
            mistake = SystemMistake(f"{said}: `{attribute}` fails ({described(error)})")
            mistake.place = place(error)
            raise mistake from error
        found = None
    if found is None and getattr(System, attribute, attribute) is not None:
        raise SystemMistake(f"{said} declares no `{attribute}`: set it in the class")
    return found
