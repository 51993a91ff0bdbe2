"""Parses the text of a fault into faults, channel by channel."""

import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, TypeAlias

from pydantic import ValidationError

from faultpath.core.errors import SystemMistake, UserError
from faultpath.core.text import listed, number_in, unknown
from faultpath.core.validation_messages import misfit_of
from faultpath.faults.fault import Fault, resolve
from faultpath.faults.kinds import INTERVENTIONS, installed_kinds, intervention_of
from faultpath.faults.text import SEVERAL, FaultText, number_of
from faultpath.interface import Interface, groups

FaultPreset: TypeAlias = Callable[[float], tuple[Fault, ...]]
"""A system's named fault, from its size to faults, which share a cause unless they name one; raises
`UserError` for a wrong size."""


def _kinds() -> tuple[str, ...]:
    """Return the kinds that text can state, which need at most one value."""
    return (*(kind for kind in INTERVENTIONS if kind != "sequence"), *installed_kinds())


_WINDOW = {
    "onset": ("onset_step", 0),
    "for": ("duration_steps", 1),
    "recover": ("recovery_steps", 0),
}
"""Options on time: the field of `Fault` and the least number of steps."""
_ANY_FAULT = tuple(f"{name}{unit}" for name in _WINDOW for unit in ("", "_s"))
"""Options that every fault takes."""


def parse_fault(
    text: str | FaultText, interface: Interface, presets: Mapping[str, FaultPreset], dt_s: float
) -> tuple[Fault, ...]:
    """Return the faults in a text, one for each channel, as `resolve` returns them.

    `dt_s` is the length of a control step, for options in seconds. Raises `UserError`, one sentence
    that quotes the text and names the known values.
    """
    parsed = FaultText.read(text) if isinstance(text, str) else text
    try:
        if len(parsed.sizes) > 1:
            raise UserError(
                "it has several sizes, and this takes one; from Python, faultpath.api.audits takes "
                "several"
            )
        faults: list[Fault] = []
        for part in (parsed, *parsed.joined):
            update, options = _timing(part.options, dt_s)
            if part.readers:
                update["readers"] = part.readers
            if parsed.joined and "loading" in options:
                update["loading"] = _loading(options.pop("loading"))
            declared = (
                _preset(part, options, interface, presets)
                if part.kind is None
                else _of_kind(part, part.kind, options, interface)
            )
            if "loading" in update and not all(f.intervention.is_random() for f in declared):
                raise UserError(_LOADING)
            stated = [
                fault.model_copy(update={"cause": fault.cause or parsed.cause, **update})
                for fault in declared
            ]
            faults += resolve(stated, interface)
        return tuple(faults)
    except UserError as error:
        raise UserError(f"fault '{parsed}': {error}") from None


def _timing(options: Mapping[str, str], dt_s: float) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the fields of a fault that give its time in force, and the other options."""
    window: dict[str, Any] = {}
    rest: dict[str, str] = {}
    for key, text in options.items():
        plain = key.removesuffix("_s")
        if plain not in _WINDOW:
            rest[key] = text
            continue
        field, minimum = _WINDOW[plain]
        if field in window:
            raise UserError(f"'{plain}' is given in steps and in seconds; drop one")
        unit, detail, length = "control steps", "", 1.0
        if plain != key:
            unit, detail, length = "seconds", f" of {dt_s:g} s each", dt_s
        value = number_of(key, text, unit) / length
        steps = round(value) if abs(value) < 1e9 else -1
        if steps < minimum or abs(value - steps) > 1e-6 * max(1.0, abs(value)):
            raise UserError(
                f"{key}={text} is not a whole number of steps{detail}, at least {minimum}"
            )
        window[field] = steps
    if "recovery_steps" in window and "duration_steps" not in window:
        raise UserError("'recover' needs an end to recover from; add for=STEPS")
    return window, rest


_LOADING = "a loading is a number from -1 to 1, and of errors that are drawn"


def _loading(text: str) -> float:
    with suppress(ValueError):
        if -1.0 <= (loading := number_in(text)) <= 1.0:
            return loading
    raise UserError(_LOADING)


def _preset(
    part: FaultText,
    options: Mapping[str, str],
    interface: Interface,
    presets: Mapping[str, FaultPreset],
) -> tuple[Fault, ...]:
    name = part.name
    if name not in presets:
        if name in groups(interface) or name in {channel.name for channel in interface.channels}:
            raise UserError(
                f"says nothing about what happens to '{name}'; write {name}:KIND=VALUE, kinds: "
                f"{listed(_kinds())}"
            )
        problem = unknown("preset", name, presets)
        raise UserError(f"{problem}; a fault of one channel is CHANNEL:KIND=VALUE")
    if not part.sizes:
        raise UserError(f"'{name}' needs a size, as in {name}=+0.1")
    if options:
        raise UserError(unknown("option", next(iter(options)), _ANY_FAULT))
    faults: Any = presets[name](number_of(name, part.sizes[0]))
    if not faults or not all(isinstance(fault, Fault) for fault in faults):
        raise SystemMistake(f"preset '{name}' of the system has to return a tuple of Faults")
    return faults


def _of_kind(
    part: FaultText, kind: str, options: Mapping[str, str], interface: Interface
) -> tuple[Fault, ...]:
    channels = groups(interface) | {channel.name: (channel.name,) for channel in interface.channels}
    if part.name not in channels:
        reading = [channel.name for channel in interface.channels if part.name in channel.sources]
        if reading:
            raise UserError(
                f"modules read '{part.name}' as '{listed(reading)}'; write {reading[0]}:{kind}"
            )
        if any(source.name == part.name for source in interface.sources):
            read = listed(channel.name for channel in interface.channels)
            raise UserError(f"no module reads '{part.name}'; they read: {read}")
        raise UserError(unknown("channel", part.name, channels))
    if kind not in _kinds():
        problem = unknown("kind", kind, _kinds())
        raise UserError(f"{problem}; a kind of another package is known once that is installed")
    head, cls = f"{part.name}:{kind}", intervention_of(kind)
    fields = [field for field in cls.model_fields if field not in ("kind", cls.value_field)]
    value_type = cls.model_fields[cls.value_field].annotation if cls.value_field else None
    needs = SEVERAL if "tuple" in str(value_type) else "a number"
    value = _value(kind, part.sizes[0], needs) if part.sizes and value_type is not str else None
    for key in options:
        if key not in fields:
            raise UserError(unknown("option", key, (*fields, *_ANY_FAULT)))
    values = {key: _value(key, text or "true") for key, text in options.items()}
    if cls.value_field is None:
        if part.sizes:
            raise UserError(f"'{kind}' takes no value; write {head}")
    elif part.sizes:
        values[cls.value_field] = part.sizes[0] if value is None else value
    elif cls.model_fields[cls.value_field].is_required():
        raise UserError(f"'{kind}' needs a value ({cls.value_field}), as in {head}=VALUE")
    try:
        intervention: Any = cls.model_validate(values)
    except ValidationError as error:
        problem = misfit_of(error)
        raise UserError(
            f"'{kind}': {problem.where or kind} {problem.message}; correct the value"
        ) from None
    return tuple(
        Fault(channel=channel, intervention=intervention) for channel in channels[part.name]
    )


def _value(key: str, text: str, needs: str = "a number") -> Any:
    if text in ("true", "false"):
        return text == "true"
    if text in _kinds():
        return {"kind": text}
    if "/" in text:
        return tuple(number_of(key, part, needs) for part in text.split("/"))
    # An integer, so that a message repeats -1 and not -1.0.
    return int(text) if re.fullmatch(r"[+-]?[0-9]{1,15}", text) else number_of(key, text, needs)
