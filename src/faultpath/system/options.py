"""The options of a system, declared by the parameters of its factory.

A factory takes keyword parameters, or one pydantic model with a field for each option. Annotations
give the type and choices of an option, and a text in `Annotated` its help:

    def create(gain: Annotated[Literal["low", "high"], "Gain of the controller."] = "low") -> System

Options are text on their way to a factory, because worker processes and run folders get them so.
"""

import inspect
import types
import typing
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from enum import Enum
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin

from pydantic import BaseModel, PydanticSchemaGenerationError, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from faultpath.core.errors import UserError
from faultpath.core.text import number_in, whole_in
from faultpath.core.validation_messages import misfit_of

Factory = Callable[..., object]
_Built = TypeVar("_Built")


_CHECKED: Mapping[str, Callable[[str], object]] = {"int": whole_in, "float": number_in}
"""Readers of text by the option's type; `ValueError` for text that is no such number."""


@dataclass(frozen=True)
class Option:
    """One option of a system."""

    name: str
    help: str = ""
    choices: tuple[str, ...] = ()
    """Choices as text; empty where values cannot be listed."""
    default: str | None = None
    """`None` if there is none, or if it depends on other options."""
    required: bool = field(default=False, compare=False, repr=False)
    values: Mapping[str, Any] = field(default_factory=dict[str, Any], compare=False, repr=False)
    """Values of the choices, by their text."""
    annotation: Any = field(default=None, compare=False, repr=False)
    factories: bool = field(default=False, compare=False, repr=False)

    @property
    def kind(self) -> str:
        """Type of its values as help shows it: `int`, `float`, or `str` for all others."""
        kind = self.annotation
        kind = _needed(get_args(kind)[0] if get_origin(kind) is Annotated else kind)
        return kind.__name__ if kind in (int, float) else "str"

    def read(self, text: str, system: str) -> Any:
        """Return the value of a text; `UserError` where there is none."""
        if self.values:
            if text in self.values:
                return self.values[text]
            if self.factories and ":" in text:
                return text
            known = ", ".join(self.values)
            own = ", or name your own as 'path/to/file.py:factory'" if self.factories else ""
            raise UserError(f"unknown {self.name} '{text}'; choose one of {known}{own}.")
        try:
            _CHECKED.get(self.kind, str)(text)
            return TypeAdapter[Any](self.annotation).validate_python(text)
        except PydanticSchemaGenerationError:
            return text  # a type of the system's own, which reads the text itself
        except ValidationError as error:
            reason = misfit_of(error).message
        except ValueError as error:
            reason = f"must be {error}"
        raise UserError(f"{system} cannot have the {self.name} '{text}': it {reason}.")


class Offered:
    """Annotation of the values that a user may choose from a wider type, such as three numbers.

    With `factories` a user may also name one as `path/to/file.py:factory`.
    """

    def __init__(self, *choices: object, factories: bool = False) -> None:
        self.choices = {_text(choice): choice for choice in choices}
        self.factories = factories


def options_of(factory: Factory) -> tuple[Option, ...]:
    """Return the options that a factory declares, in its order."""
    return tuple(_declared(factory)[0].values())


def call(factory: Callable[..., _Built], texts: Mapping[str, str], system: str) -> _Built:
    """Return the object that a factory builds from options given as text.

    Raises `UserError`, naming `system`, for an unknown or missing option, and for a value that the
    option cannot have.
    """
    options, model, any_other = _declared(factory)
    names = ", ".join(options)
    for name in texts:
        if name not in options and not any_other:
            raise UserError(
                f"the options of {system} do not include '{name}': it takes {names or 'none'}."
            )
    for name, option in options.items():
        if option.required and name not in texts:
            raise UserError(f"{system} needs the option '{name}': give it, it takes {names}.")
    values = {k: options[k].read(v, system) if k in options else v for k, v in texts.items()}
    if model is None:
        return factory(**values)
    try:
        return factory(model.model_validate(values))
    except ValidationError as error:
        raise UserError(f"the options of {system} do not fit: {misfit_of(error)}.") from None


def builds(factory: Factory, kinds: Sequence[type]) -> bool:
    """Return whether a factory is one of some classes, or is annotated to return one.

    The annotation may name a class that is imported for type checkers only.
    """
    builder: Any = inspect.unwrap(factory)
    known = {kind.__name__: kind for kind in kinds}
    kind = builder if isinstance(builder, type) else _hints(builder, known).get("return")
    several = get_args(kind) or (kind,)
    return all(isinstance(member, type) and issubclass(member, tuple(kinds)) for member in several)


def as_text(options: Mapping[str, object]) -> dict[str, str]:
    """Return options as text; `UserError` for a value that has none."""
    for name, value in options.items():
        if not isinstance(value, str | int | float | Enum):
            raise UserError(
                f"the option {name!r} is a {type(value).__name__}: give text or a number."
            )
    return {name: _text(value) for name, value in options.items()}


def _declared(factory: Factory) -> tuple[dict[str, Option], type[BaseModel] | None, bool]:
    """Return the options of a factory, their model if any, and whether it takes any others."""
    try:
        parameters: Mapping[str, inspect.Parameter] = inspect.signature(factory).parameters
    except (TypeError, ValueError):  # some built-in functions have no signature
        parameters = dict[str, inspect.Parameter]()
    hints = _hints(factory.__init__ if isinstance(factory, type) else factory, {})
    only = hints.get(next(iter(parameters))) if len(parameters) == 1 else None
    model = only if isinstance(only, type) and issubclass(only, BaseModel) else None
    fields = dict[str, FieldInfo]() if model is None else model.model_fields
    for name, parameter in parameters.items():
        kinds = (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY)
        if model is None and parameter.kind in kinds:
            written = parameter.annotation
            known = str if isinstance(written, str) else written
            default = ... if parameter.default is parameter.empty else parameter.default
            if written is parameter.empty:  # a flag that is off by default is no text
                known = type(default) if isinstance(default, bool | int | float) else str
            fields[name] = FieldInfo.from_annotated_attribute(hints.get(name, known), default)
    options = dict[str, Option]()
    for name, info in fields.items():
        offered = next((note for note in info.metadata if isinstance(note, Offered)), None)
        values = _values(info.annotation) if offered is None else offered.choices
        required = info.is_required()
        options[name] = Option(
            name,
            " ".join(note for note in info.metadata if isinstance(note, str)),
            tuple(values),
            None if required or info.default is None else _text(info.default),
            required,
            values,
            Annotated[info.annotation, *info.metadata] if info.metadata else info.annotation,
            bool(offered and offered.factories),
        )
    return (
        options,
        model,
        any(argument.kind is argument.VAR_KEYWORD for argument in parameters.values()),
    )


def _hints(builder: Any, known: Mapping[str, type]) -> dict[str, Any]:
    """Return the annotations that can be resolved; `known` defines further names."""
    names, hints = {**known, **getattr(builder, "__globals__", {})}, dict[str, Any]()
    for name, written in getattr(builder, "__annotations__", {}).items():
        holder = types.SimpleNamespace(__annotations__={name: written})
        with suppress(
            NameError, TypeError, AttributeError, SyntaxError
        ):  # names for type checkers only
            hints |= typing.get_type_hints(holder, names, include_extras=True)
    return hints


def _needed(kind: Any) -> Any:
    """Return `kind` without `None`."""
    some = [member for member in get_args(kind) if member is not types.NoneType]
    return some[0] if len(some) == 1 and len(get_args(kind)) == 2 else kind


def _values(kind: Any) -> dict[str, Any]:
    kind = _needed(kind)
    if isinstance(kind, type) and issubclass(kind, Enum):
        return {_text(member): member for member in kind}
    if kind is bool or get_origin(kind) is Literal:
        return {_text(value): value for value in get_args(kind) or (True, False)}
    return {}


def _text(value: object) -> str:
    if isinstance(value, Enum):
        return str(value.value)
    return str(value).lower() if isinstance(value, bool) else str(value)
