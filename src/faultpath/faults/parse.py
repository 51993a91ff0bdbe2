"""Faults as text, for the command line.

    gain:delay=5                        CHANNEL:KIND=VALUE, at every consumer of the channel
    velocity:offset=1/0/0               a vector
    velocity:noise=0.1,relative         more fields of the intervention after commas
    velocity:freeze,onset=20,for=40     when, in control steps; onset_s= and for_s= in seconds
    gain:scale=1.1@observer+controller.inverse   only these modules and consumers
    PRESET=+0.1                         a fault that the system names

Further sizes stand after commas without a name: `gain:scale=0.8,0.9,1.1,onset=20@observer`, or a
range `FROM..TO/COUNT`. The name of a correlation group may stand for its channels.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Self, TypeAlias

from pydantic import ValidationError

from faultpath.core.errors import UserError
from faultpath.core.numbers import number_in
from faultpath.core.text import listed, unknown
from faultpath.core.validation_messages import misfit_of
from faultpath.faults.fault import INTERVENTIONS, Coupled, Fault
from faultpath.interface import Interface, groups

FaultPreset: TypeAlias = Callable[[float], Coupled]
"""A system's named fault: its size in, the faults out; raises `UserError` for a wrong size."""

KINDS = {kind: intervention for kind, intervention in INTERVENTIONS.items() if kind != "sequence"}
"""Interventions that text can state: those that need no more than one value."""

_WINDOW = {
    "onset": ("onset_step", 0),
    "for": ("duration_steps", 1),
    "recover": ("recovery_steps", 0),
}
"""Options on time: the field of `Fault` and the least number of steps."""
_ANY_FAULT = tuple(f"{name}{unit}" for name in _WINDOW for unit in ("", "_s"))
"""Options that every fault takes."""

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_SIZE = re.compile(rf"{_NUMBER}(?:/{_NUMBER})*")
_RANGE = re.compile(rf"({_NUMBER})\.\.({_NUMBER})/([0-9]+)")
_MOST = 99
"""Sizes of one range; each is an audit."""


@dataclass(frozen=True)
class FaultText:
    """The parts of a fault's text, not yet understood."""

    name: str
    """Name of a channel, a correlation group or a preset."""
    kind: str | None
    """`None` for a preset."""
    sizes: tuple[str, ...]
    options: Mapping[str, str]
    consumers: tuple[str, ...]

    @classmethod
    def read(cls, text: str) -> Self:
        """Take a text apart; a range `FROM..TO/COUNT` stands for that many sizes, both ends too.

        `UserError` for what has no such form.
        """
        try:
            return cls._read(text)
        except UserError as error:
            raise UserError(f"fault '{text}': {error}") from None

    @classmethod
    def _read(cls, text: str) -> Self:
        if not text.strip():
            raise UserError("the text is empty; write CHANNEL:KIND=VALUE or PRESET=SIZE")
        items: list[str] = []
        consumers: list[str] = []
        for item in text.split(","):
            head, at, names = (part.strip() for part in item.partition("@"))
            if at and (consumers or "@" in names):
                raise UserError("'@' appears twice; join consumers with '+', as in @planner+other")
            if at:
                consumers = [name.strip() for name in names.split("+")]
                if not all(consumers):
                    raise UserError("'@' needs a module or consumer after it, as in @planner")
            if not head:
                raise UserError("something is missing between commas; write CHANNEL:KIND=VALUE")
            items.append(head)
        what, has_size, size = items[0].partition("=")
        name, has_kind, kind = what.partition(":")
        sizes = [*_spread(size)] if has_size else []
        options: dict[str, str] = {}
        for item in items[1:]:
            key, equals, value = item.partition("=")
            if not equals and (_SIZE.fullmatch(item) or ".." in item):
                if not has_size:
                    raise UserError(
                        f"{item} is a further size, and there is no first: write "
                        "CHANNEL:KIND=SIZE,SIZE"
                    )
                sizes += _spread(item)
                continue
            if key in options:
                raise UserError(f"option '{key}' appears twice; drop one")
            options[key] = value
        if len({tuple(map(float, s.split("/"))) if _SIZE.fullmatch(s) else s for s in sizes}) < len(
            sizes
        ):
            raise UserError("it names a size twice: name each once")
        named = tuple(dict.fromkeys(consumers))
        return cls(name, kind if has_kind else None, tuple(sizes), options, named)

    def at(self, size: str) -> Self:
        """Return the same fault of one size."""
        return replace(self, sizes=(size,))

    def __str__(self) -> str:
        head = self.name if self.kind is None else f"{self.name}:{self.kind}"
        sized = f"{head}={','.join(self.sizes)}" if self.sizes else head
        options = (f"{key}={value}" if value else key for key, value in self.options.items())
        at = f"@{'+'.join(self.consumers)}" if self.consumers else ""
        return ",".join((sized, *options)) + at


def each_size(text: str) -> tuple[str, ...]:
    """Return the text of a fault for each of its sizes; a fault of one size is its own only text.

    `UserError` for a text that has no such form.
    """
    parts = FaultText.read(text)
    if len(parts.sizes) < 2:
        return (text,)
    return tuple(str(parts.at(size)) for size in parts.sizes)


def _spread(item: str) -> tuple[str, ...]:
    match = _RANGE.fullmatch(item)
    if match is None:
        if ".." in item:
            raise UserError(
                "a range cannot be read: write FROM..TO/COUNT, as in gain:scale=0.6..1.2/7"
            )
        return (item,)
    low, high, count = match.groups()
    if len(count) > len(str(_MOST)) or not 2 <= int(count) <= _MOST:
        raise UserError(f"it asks for {count} sizes: a range takes 2 to {_MOST}")
    first, last, steps = _number("from", low), _number("to", high), int(count) - 1
    return tuple(f"{(first * (steps - i) + last * i) / steps + 0.0:.10g}" for i in range(steps + 1))


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
            raise UserError("it has several sizes: use faultpath.api.audits")
        update, options = _timing(parts.options, dt_s)
        if parts.consumers:
            update["consumers"] = parts.consumers
        if parts.kind is None:
            fault = _preset(parts, options, interface, presets)
        else:
            fault = _intervention(parts, parts.kind, options, interface)
        if isinstance(fault, Coupled):
            updated = tuple(part.model_copy(update=update) for part in fault.faults)
            fault = fault.model_copy(update={"faults": updated})
        else:
            fault = fault.model_copy(update=update)
        fault.resolved(interface)
    except UserError as error:
        raise UserError(f"fault '{text}': {error}") from None
    return fault


def _timing(options: Mapping[str, str], dt_s: float) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the fields of a fault that say when it is in force, and the other options."""
    when: dict[str, Any] = {}
    rest: dict[str, str] = {}
    for key, text in options.items():
        plain = key.removesuffix("_s")
        if plain not in _WINDOW:
            rest[key] = text
            continue
        field, least = _WINDOW[plain]
        if field in when:
            raise UserError(f"'{plain}' is given in steps and in seconds; drop one")
        unit, of, length = "control steps", "", 1.0
        if plain != key:
            unit, of, length = "seconds", f" of {dt_s:g} s each", dt_s
        value = _number(key, text, unit) / length
        steps = round(value) if abs(value) < 1e9 else -1
        if steps < least or abs(value - steps) > 1e-6 * max(1.0, abs(value)):
            raise UserError(f"{key}={text} is not a whole number of steps{of}, at least {least}")
        when[field] = steps
    if "recovery_steps" in when and "duration_steps" not in when:
        raise UserError("'recover' needs an end to recover from; add for=STEPS")
    return when, rest


def _preset(
    parts: FaultText,
    options: Mapping[str, str],
    interface: Interface,
    presets: Mapping[str, FaultPreset],
) -> Coupled:
    name = parts.name
    if name not in presets:
        if name in groups(interface) or name in {channel.name for channel in interface.channels}:
            raise UserError(
                f"says nothing about what happens to '{name}'; write {name}:KIND=VALUE, kinds: "
                f"{listed(KINDS)}"
            )
        problem = unknown("preset", name, presets)
        raise UserError(f"{problem}; a fault of one channel is CHANNEL:KIND=VALUE")
    if not parts.sizes:
        raise UserError(f"'{name}' needs a size, as in {name}=+0.1")
    if options:
        raise UserError(unknown("option", next(iter(options)), _ANY_FAULT))
    return presets[name](_number(name, parts.sizes[0]))


def _intervention(
    parts: FaultText, kind: str, options: Mapping[str, str], interface: Interface
) -> Fault | Coupled:
    together = groups(interface)
    targets = together | {channel.name: (channel.name,) for channel in interface.channels}
    if parts.name not in targets:
        raise UserError(unknown("channel", parts.name, targets))
    if kind not in KINDS:
        raise UserError(unknown("kind", kind, KINDS))
    head, cls = f"{parts.name}:{kind}", KINDS[kind]
    fields = [field for field in cls.model_fields if field not in ("kind", cls.value_field)]
    for key in options:
        if key not in fields:
            raise UserError(unknown("option", key, (*fields, *_ANY_FAULT)))
    values = {key: _value(key, text or "true") for key, text in options.items()}
    if cls.value_field is None:
        if parts.sizes:
            raise UserError(f"'{kind}' takes no value; write {head}")
    elif parts.sizes:
        size, annotation = parts.sizes[0], cls.model_fields[cls.value_field].annotation
        values[cls.value_field] = size if annotation is str else _value(kind, size)
    elif cls.model_fields[cls.value_field].is_required():
        raise UserError(f"'{kind}' needs a value ({cls.value_field}), as in {head}=VALUE")
    try:
        built: Any = cls.model_validate(values)
    except ValidationError as error:
        problem = misfit_of(error)
        raise UserError(
            f"'{kind}': {problem.where or kind} {problem.says}; correct the value"
        ) from None
    faults = tuple(Fault(channel=channel, intervention=built) for channel in targets[parts.name])
    return Coupled(name=head, faults=faults) if parts.name in together else faults[0]


def _value(key: str, text: str) -> Any:
    if text in ("true", "false"):
        return text == "true"
    if text in KINDS:
        return {"kind": text}
    if "/" in text:
        return tuple(_number(key, part) for part in text.split("/"))
    # What is echoed in a refusal is what was written, -1 and not -1.0.
    return int(text) if re.fullmatch(r"[+-]?[0-9]{1,15}", text) else _number(key, text)


def _number(key: str, text: str, what: str = "a number") -> float:
    try:
        return number_in(text)
    except ValueError as error:
        needs = what if str(error) == "a number" else error
        raise UserError(f"'{key}' needs {needs}, not '{text}'") from None
