"""The options of a system, read from what its factory takes, and handed to it.

A factory takes keyword parameters, or one pydantic model with a field for each option. Annotations
say of what type an option is, what may be chosen, and, as a text in `Annotated`, what it means:

    def create(gain: Annotated[Literal["low", "high"], "Gain of the controller."] = "low") -> System

Options are text on their way to a factory, because worker processes and run folders get them so.
"""

import inspect
import types
import typing
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from typing import Any, Literal, TypeVar, get_args, get_origin

from pydantic import BaseModel, PydanticSchemaGenerationError, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from faultpath.core.errors import UserError
from faultpath.core.misfits import misfit_of

Factory = Callable[..., object]
_Built = TypeVar("_Built")


@dataclass(frozen=True)
class Option:
    """One option of a system."""

    name: str
    help: str = ""
    choices: tuple[str, ...] = ()
    """What may be chosen, as text; empty where the values cannot be listed."""
    default: str | None = None
    """`None` where there is none, or where other options decide."""


class Offered:
    """In `Annotated`: what of a wider type may be chosen from outside, such as three numbers.

    With `factories` also what a user brings, named as `path/to/file.py:factory`.
    """

    def __init__(self, *choices: object, factories: bool = False) -> None:
        self.choices = {_text(choice): choice for choice in choices}
        self.factories = factories


@dataclass(frozen=True)
class _Slot:
    """Where a factory takes an option."""

    option: Option
    annotation: Any
    values: Mapping[str, Any]
    """By text, where they can be listed."""
    required: bool
    factories: bool = False

    def read(self, text: str, system: str) -> Any:
        """Return the value that `text` stands for; `UserError` where there is none."""
        if self.values:
            if text in self.values:
                return self.values[text]
            if self.factories and ":" in text:
                return text
            known = ", ".join(self.values)
            own = ", or name your own as 'path/to/file.py:factory'" if self.factories else ""
            raise UserError(f"unknown {self.option.name} '{text}'; choose one of {known}{own}.")
        try:
            return TypeAdapter[Any](self.annotation).validate_python(text)
        except PydanticSchemaGenerationError:
            return text  # a type of the system's own: it may make of the text what it likes
        except ValidationError as error:
            raise UserError(
                f"{system} cannot have the {self.option.name} '{text}': it {misfit_of(error).says}."
            ) from None


def options_of(factory: Factory) -> tuple[Option, ...]:
    """Return the options that a factory declares, in its order."""
    return tuple(slot.option for slot in _slots(factory)[0].values())


def call(factory: Callable[..., _Built], given: Mapping[str, str], system: str) -> _Built:
    """Return what a factory builds from options given as text.

    Raises `UserError`, naming `system`, for an option that the factory does not take or lacks, and
    for a value that the option cannot have.
    """
    slots, model, any_other = _slots(factory)
    names = ", ".join(slots)
    for name in given:
        if name not in slots and not any_other:
            raise UserError(
                f"the options of {system} do not include '{name}': it takes {names or 'none'}."
            )
    for name, slot in slots.items():
        if slot.required and name not in given:
            raise UserError(f"{system} needs the option '{name}': give it, it takes {names}.")
    values = {k: slots[k].read(v, system) if k in slots else v for k, v in given.items()}
    if model is None:
        return factory(**values)
    try:
        return factory(model.model_validate(values))
    except ValidationError as error:
        raise UserError(f"the options of {system} do not fit: {misfit_of(error)}.") from None


def as_text(options: Mapping[str, object]) -> dict[str, str]:
    """Return options as the text that stands for them; `UserError` for what has none."""
    for name, value in options.items():
        if not isinstance(value, str | int | float | Enum):
            raise UserError(
                f"the option {name!r} is a {type(value).__name__}: give text or a number."
            )
    return {name: _text(value) for name, value in options.items()}


def _slots(factory: Factory) -> tuple[dict[str, _Slot], type[BaseModel] | None, bool]:
    """Return where a factory takes its options, their model if any, and if it takes any other."""
    try:
        parameters: Mapping[str, inspect.Parameter] = inspect.signature(factory).parameters
    except (TypeError, ValueError):  # of some built-in functions nothing is known
        parameters = dict[str, inspect.Parameter]()
    hints = _hints(factory)
    only = hints.get(next(iter(parameters))) if len(parameters) == 1 else None
    if isinstance(only, type) and issubclass(only, BaseModel):
        return {name: _slot(name, field) for name, field in only.model_fields.items()}, only, False
    slots: dict[str, _Slot] = {}
    for name, parameter in parameters.items():
        if parameter.kind in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY):
            written = parameter.annotation
            known = str if written is parameter.empty or isinstance(written, str) else written
            default = ... if parameter.default is parameter.empty else parameter.default
            field = FieldInfo.from_annotated_attribute(hints.get(name, known), default)
            slots[name] = _slot(name, field)
    return slots, None, any(each.kind is each.VAR_KEYWORD for each in parameters.values())


def _slot(name: str, field: FieldInfo) -> _Slot:
    said = " ".join(note for note in field.metadata if isinstance(note, str))
    offered = next((note for note in field.metadata if isinstance(note, Offered)), None)
    values = _values(field.annotation) if offered is None else offered.choices
    required = field.is_required()
    shown = None if required or field.default is None else _text(field.default)
    option = Option(name, said, tuple(values), shown)
    return _Slot(option, field.annotation, values, required, bool(offered and offered.factories))


def _values(kind: Any) -> dict[str, Any]:
    if isinstance(kind, type) and issubclass(kind, Enum):
        return {_text(member): member for member in kind}
    inner = get_args(kind)
    if kind is bool or get_origin(kind) is Literal:
        return {_text(value): value for value in inner or (True, False)}
    if len(inner) == 2 and type(None) in inner:
        return _values(inner[0] if inner[1] is type(None) else inner[1])
    return {}


def _text(value: object) -> str:
    if isinstance(value, Enum):
        return str(value.value)
    return str(value).lower() if isinstance(value, bool) else str(value)


def _hints(factory: Factory) -> dict[str, Any]:
    made: Any = factory.__init__ if isinstance(factory, type) else factory
    names, found = getattr(made, "__globals__", {}), dict[str, Any]()
    for name, written in getattr(made, "__annotations__", {}).items():
        holder = types.SimpleNamespace(__annotations__={name: written})
        with suppress(NameError, TypeError, AttributeError, SyntaxError):  # for type checkers only
            found |= typing.get_type_hints(holder, names, include_extras=True)
    return found
