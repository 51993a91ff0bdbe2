"""What a user's system must be like, so that nothing fails halfway for want of it."""

import re
from collections.abc import Mapping
from dataclasses import fields
from numbers import Integral, Real
from typing import Any, TypeVar, cast

from faultpath.errors import SystemMistake, UserError
from faultpath.interface import Interface
from faultpath.taps.tap import wire
from faultpath.trials.declared import Library, Variant, check_name, shown
from faultpath.trials.metrics import Metric
from faultpath.trials.outcome import Outcome
from faultpath.trials.system import System

_Kind = TypeVar("_Kind")

COLUMNS = frozenset(
    {"variant", "path", "seed", "scene", "scene_index", "topology", "x_m", "y_m", "z_m"}
    | {f.name for f in fields(Outcome)}
)
"""Names that the table of outcomes has already."""


def library_of(system: System, name: str) -> Library:
    """Return a library of a system; `SystemMistake` for what is none, `UserError` for no name."""
    return _returned(system, "library", system.library(name), Library, "a Library")


def fingerprint_of(system: System) -> str:
    """Return what the system says of itself; `SystemMistake` for what is no text."""
    return _returned(system, "fingerprint", system.fingerprint(), str, "text")


def _returned(system: System, method: str, found: object, kind: type[_Kind], wanted: str) -> _Kind:
    if not isinstance(found, kind):
        raise SystemMistake(
            f"system '{system.name}': `{method}` returned {shown(found)}: it must return {wanted}"
        )
    return found


def check_system(system: System, name: str) -> None:
    """Raise `SystemMistake` unless `system` declares what every audit asks of it.

    `name` is what the user calls it by.
    """
    said = f"system {name!r}"
    check_name(f"{said}: `name`", _declared(system, "name", said))
    step = _declared(system, "control_dt_s", said)
    if not isinstance(step, Real) or not 0 < float(step) < float("inf"):
        raise SystemMistake(
            f"{said}: `control_dt_s` is {shown(step)}: give the seconds of a control step"
        )
    block: Any = system.block_size
    if not isinstance(block, Integral) or int(block) < 1:
        raise SystemMistake(
            f"{said}: `block_size` is {shown(block)}: give a whole number, 1 or more"
        )
    interface = _declared(system, "interface", said)
    if not isinstance(interface, Interface):
        raise SystemMistake(
            f"{said}: `interface` is {shown(interface)}: give what `read_interface` returns"
        )
    _check_metrics(system.metrics, said)
    variants = _declared(system, "variants", said)
    if not isinstance(variants, Mapping) or not variants:
        raise SystemMistake(f"{said}: `variants` is {shown(variants)}: map names to variants")
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


def _check_metrics(found: Any, said: str) -> None:
    if not isinstance(found, Mapping):
        raise SystemMistake(f"{said}: `metrics` is {shown(found)}: map names to metrics")
    for name, metric in cast("Mapping[Any, Any]", found).items():
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
    except AttributeError:
        if hasattr(type(system), attribute):  # a property of the system's that fails
            raise
        found = None
    if found is None:
        raise SystemMistake(f"{said} declares no `{attribute}`: set it in the class")
    return found
