"""What a user's system must be like, so that nothing fails halfway for want of it."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from numbers import Integral, Real
from os import PathLike
from typing import Any, TypeVar, cast

from faultpath.blame import described, place
from faultpath.errors import SystemMistake, UserError
from faultpath.interface import Interface
from faultpath.taps.tap import wire
from faultpath.trials.declared import Library, Variant, check_name, shown
from faultpath.trials.metrics import Metric
from faultpath.trials.outcome import Outcome, Status
from faultpath.trials.system import System

_Kind = TypeVar("_Kind")

COLUMNS = frozenset(
    {"variant", "path", "seed", "scene", "scene_index", "topology", "x_m", "y_m", "z_m"}
    | {f.name for f in fields(Outcome)}
)
"""Names that the table of outcomes has already."""


def library_of(system: System, name: str) -> Library:
    """Return a library of a system; `SystemMistake` for what is none, `UserError` for no name.

    A system that takes no notice of names has its one library under the names that stand for one
    where none is given; any other would be a misspelling that nobody sees.
    """
    found = _returned(system, "library", system.library(name), Library, "a Library")
    if name in UNNAMED:
        return found
    if found.name != name:
        raise SystemMistake(
            f"system '{system.name}' gave library '{found.name}' for '{name}': ask for it by its "
            "own name, and let `library` raise UserError for any other"
        )
    if _answers_alike(system, found):
        raise SystemMistake(
            f"system '{system.name}' gives the same scenes for library '{name}' and for any other "
            "name: leave the name out, or let `library` raise UserError for names that it does not "
            "know"
        )
    return found


UNNAMED = ("held-out", "selection")
"""What audits and checks ask for where no library is named."""


def _answers_alike(system: System, library: Library) -> bool:
    try:
        other = system.library("there is no library of this name")
    except Exception:  # as it should for a name that nobody has
        return False
    same = (library.scenes, library.content_hash)
    return isinstance(other, Library) and (other.scenes, other.content_hash) == same  # pyright: ignore[reportUnnecessaryIsInstance]


def fingerprint_of(system: System) -> str:
    """Return what the system says of itself; `SystemMistake` for what is no text."""
    return _returned(system, "fingerprint", system.fingerprint(), str, "text")


def _returned(system: System, method: str, found: object, kind: type[_Kind], wanted: str) -> _Kind:
    if not isinstance(found, kind):
        raise SystemMistake(
            f"system '{system.name}': `{method}` returned {shown(found)}: it must return {wanted}"
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
    _check_metrics(found["metrics"], said)
    interface, variants = found["interface"], found["variants"]
    for key, variant in cast("Mapping[Any, Any]", variants).items():
        if not isinstance(variant, Variant) or variant.name != key:
            raise SystemMistake(
                f"{said}: `variants` holds {shown(variant)} under {shown(key)}: map the name of "
                "each Variant to it"
            )
        try:
            wire(interface, variant.bindings, variant.consumers, variant.privileged, 0)
        except UserError as error:
            raise SystemMistake(f"{said}: variant '{key}': {error}") from None


def _positive(found: Any) -> bool:
    return isinstance(found, Real) and 0 < float(found) < float("inf")


def _words(found: Any) -> bool:
    return isinstance(found, Mapping) and all(
        isinstance(key, Status) and isinstance(words, str)
        for key, words in cast("Mapping[Any, Any]", found).items()
    )


def _presets(found: Any) -> bool:
    return isinstance(found, Mapping) and all(
        isinstance(key, str) and callable(preset)
        for key, preset in cast("Mapping[Any, Any]", found).items()
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
    "metrics": (lambda found: isinstance(found, Mapping), "map names to metrics"),
    "ends": (_words, "map a Status to what it is called"),
    "fault_presets": (_presets, "map names to functions that return a fault"),
    "variants": (
        lambda found: isinstance(found, Mapping) and len(cast("Any", found)) > 0,
        "map names to variants",
    ),
}
"""What an audit reads of every system, what must hold of it, and what to do where it does not."""


def _check_metrics(found: Mapping[Any, Any], said: str) -> None:
    for name, metric in found.items():
        if not isinstance(metric, Metric):
            raise SystemMistake(
                f"{said}: metric {shown(name)} is {shown(metric)}: give a Metric, with its unit"
            )
        if not re.fullmatch(r"[a-z][a-z0-9_]*", str(name)) or name in COLUMNS:
            raise SystemMistake(
                f"{said}: a metric is called {shown(name)}: take small letters, digits and '_', "
                "and no name that the table of outcomes has already"
            )


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
