"""Faults as text, for the command line.

    calibration=+0.1                    a preset that the system names
    wind:delay=5                        CHANNEL:KIND=VALUE, at every consumer of the channel
    wind:offset=1/0/0                   a vector
    velocity:noise=0.1,relative         more fields of the intervention after commas
    wind:freeze,onset=20,for=40         when, in control steps; onset_s= and for_s= in seconds
    mass:scale=1.1@planner+predictor.trim   only these modules and consumers

A correlation group may stand for its channels: `calibration:scale=1.1`.
"""

import re
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

from pydantic import ValidationError

from faultpath.core.errors import UserError
from faultpath.core.misfits import misfit_of
from faultpath.core.text import listed, unknown
from faultpath.faults.fault import Coupled, Fault
from faultpath.faults.registry import INTERVENTIONS, AnyIntervention
from faultpath.faults.text import FaultText
from faultpath.interface import Interface, groups

FaultPreset: TypeAlias = Callable[[float], Coupled]
"""A system's named fault: its size in, the faults out; raises `UserError` for a wrong size."""

KINDS = {
    kind: intervention
    for kind, intervention in INTERVENTIONS.items()
    if all(
        name == intervention.value_field
        for name, field in intervention.model_fields.items()
        if field.is_required()
    )
}
"""Interventions that text can state: those that need no more than one value."""

_WINDOW = {
    "onset": ("onset_step", 0),
    "for": ("duration_steps", 1),
    "recover": ("recovery_steps", 0),
}
"""Options on time: the field of `Fault` and the least number of steps."""
_ANY_FAULT = tuple(f"{name}{unit}" for name in _WINDOW for unit in ("", "_s"))
"""Options that every fault takes."""


def parse_fault(
    text: str, interface: Interface, presets: Mapping[str, FaultPreset], dt_s: float
) -> Fault | Coupled:
    """Return the fault that `text` states, checked against `interface`.

    `dt_s` is the length of a control step, for options in seconds. Raises `UserError`, one sentence
    that quotes the text and names the known values.
    """
    parts = FaultText.read(text)
    try:
        if len(parts.sizes) > 1:
            raise UserError("it has several sizes: audit each with faultpath.audits")
        when, rest = _timing(parts.options, dt_s)
        size = parts.sizes[0] if parts.sizes else None
        if parts.kind is None:
            fault = _preset(parts.name, size, rest, interface, presets)
        else:
            fault = _intervention(parts.name, parts.kind, size, rest, interface)
        if isinstance(fault, Coupled):
            timed = tuple(each.model_copy(update=when) for each in fault.faults)
            fault = fault.model_copy(update={"faults": timed})
        else:
            fault = fault.model_copy(update=when)
        if parts.consumers:
            fault = fault.aimed_at(*parts.consumers)
        fault.validate_against(interface)
    except UserError as error:
        raise UserError(f"fault '{text}': {error}") from None
    return fault


def _timing(options: Mapping[str, str], dt_s: float) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the fields of a fault that say when it is in force, and the other options."""
    when: dict[str, Any] = {}
    rest: dict[str, str] = {}
    for key, given in options.items():
        plain = key.removesuffix("_s")
        if plain not in _WINDOW:
            rest[key] = given
            continue
        field, least = _WINDOW[plain]
        if field in when:
            raise UserError(f"'{plain}' is given in steps and in seconds; drop one")
        when[field] = _steps(key, given, least, dt_s if plain != key else None)
    if "recovery_steps" in when and "duration_steps" not in when:
        raise UserError("'recover' needs an end to recover from; add for=STEPS")
    return when, rest


def _steps(key: str, given: str, least: int, dt_s: float | None) -> int:
    unit = "control steps" if dt_s is None else "seconds"
    value = _number(key, given, unit) / (dt_s or 1.0)
    steps = round(value) if abs(value) < 1e9 else -1
    if steps < least or abs(value - steps) > 1e-6 * max(1.0, abs(value)):
        of = "" if dt_s is None else f" of {dt_s:g} s each"
        raise UserError(f"{key}={given} is not a whole number of steps{of}, at least {least}")
    return steps


def _number(key: str, given: str, what: str = "a number") -> float:
    try:
        value = float(given.replace("_", "?"))  # Python reads 1_0 as ten
    except ValueError:
        raise UserError(f"'{key}' needs {what}, not '{given}'") from None
    if value - value != 0.0:  # infinite or NaN
        raise UserError(f"'{key}' needs a finite number, not '{given}'")
    return value


def _preset(
    name: str,
    size: str | None,
    options: Mapping[str, str],
    interface: Interface,
    presets: Mapping[str, FaultPreset],
) -> Coupled:
    if name not in presets:
        if name in _targets(interface):
            raise UserError(
                f"says nothing about what happens to '{name}'; write {name}:KIND=VALUE, kinds: "
                f"{listed(KINDS)}"
            )
        said = unknown("preset", name, presets)
        raise UserError(f"{said}; a fault of one channel is CHANNEL:KIND=VALUE")
    if size is None:
        raise UserError(f"'{name}' needs a size, as in {name}=+0.1")
    if options:
        raise UserError(unknown("option", next(iter(options)), _ANY_FAULT))
    return presets[name](_number(name, size))


def _targets(interface: Interface) -> dict[str, tuple[str, ...]]:
    channels = {channel.name: (channel.name,) for channel in interface.channels}
    return groups(interface) | channels


def _intervention(
    name: str, kind: str, value: str | None, options: Mapping[str, str], interface: Interface
) -> Fault | Coupled:
    targets = _targets(interface)
    if name not in targets:
        raise UserError(unknown("channel", name, targets))
    if kind not in KINDS:
        raise UserError(unknown("kind", kind, KINDS))
    built = _build(f"{name}:{kind}", kind, value, dict(options))
    faults = tuple(Fault(channel=channel, intervention=built) for channel in targets[name])
    if name in groups(interface):
        return Coupled(name=f"{name}:{kind}", faults=faults)
    return faults[0]


def _build(said: str, kind: str, value: str | None, options: dict[str, str]) -> AnyIntervention:
    cls = KINDS[kind]
    fields = [field for field in cls.model_fields if field not in ("kind", cls.value_field)]
    for key in options:
        if key not in fields:
            raise UserError(unknown("option", key, (*fields, *_ANY_FAULT)))
    given = {key: _value(key, text or "true") for key, text in options.items()}
    if cls.value_field is None:
        if value is not None:
            raise UserError(f"'{kind}' takes no value; write {said}")
    elif value is not None:
        given[cls.value_field] = _value(kind, value)
    elif cls.model_fields[cls.value_field].is_required():
        raise UserError(f"'{kind}' needs a value ({cls.value_field}), as in {said}=VALUE")
    try:
        built: Any = cls.model_validate(given)
    except ValidationError as error:
        found = misfit_of(error)
        where = found.where or kind
        raise UserError(f"'{kind}': {where} {found.says}; correct the value") from None
    return built


def _value(key: str, text: str) -> Any:
    if text in ("true", "false"):
        return text == "true"
    if text in KINDS:
        return {"kind": text}
    if "/" in text:
        return tuple(_number(key, part) for part in text.split("/"))
    # What is echoed in a refusal is what was written, -1 and not -1.0.
    return int(text) if re.fullmatch(r"[+-]?\d{1,15}", text) else _number(key, text)
