"""The fields of a question as flags of a verb."""

import inspect
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin

import typer

from faultpath.cli.options import path
from faultpath.trials.question import Flag, Request, flag, panel, settings

_Verb = TypeVar("_Verb", bound=Callable[..., Any])
_PLAIN = (str, int, float, bool)


def takes(model: type[Request], *without: str) -> Callable[[_Verb], _Verb]:
    """Give a verb the flags of a model.

    The verb has a last parameter `**given`, which gets what the line says, by the model's names.
    Fields named in `without` have no flag.
    """
    fields = {name: each for name, each in model.model_fields.items() if name not in without}

    def decorate(verb: _Verb) -> _Verb:
        @wraps(verb)
        def command(**line: Any) -> Any:
            given = {name: line.pop(name) for name in fields}
            for name, field in fields.items():
                if field.default is True:
                    given[name] = not given[name]
            if "options" in given:
                given["options"] = settings(given["options"] or [])
            return verb(**line, **{k: v for k, v in given.items() if v is not None})

        own = [
            each
            for each in inspect.signature(verb).parameters.values()
            if each.kind != each.VAR_KEYWORD
        ]
        flags = [_parameter(model, name) for name in fields]
        parameters = [each.replace(kind=inspect.Parameter.KEYWORD_ONLY) for each in (*own, *flags)]
        # Arguments go before, then what is required; typer keeps the order within a panel.
        vars(command)["__signature__"] = inspect.Signature(parameters)
        return command  # pyright: ignore[reportReturnType]

    return decorate


def _parameter(model: type[Request], name: str) -> inspect.Parameter:
    field = model.model_fields[name]
    several = any(isinstance(note, Flag) and note.several for note in field.metadata)
    kind, extra = _kind(field.annotation), dict[str, Any]()
    if kind is Path:
        extra["parser"] = path
    default: Any = field.default
    if field.is_required():
        default = inspect.Parameter.empty
    elif several or default in ("", (), None):
        default = None
    elif isinstance(default, tuple):
        default = ",".join(f"{each:g}" for each in field.default)
    elif default is True:
        default = False
    hint: Any = kind
    if several:
        hint = list[str] | None
    elif default is None:
        hint = kind | None
    told = field.description or ""
    said = typer.Option(
        flag(model, name),
        help=f"Do not {told[0].lower()}{told[1:]}" if field.default is True else told,
        rich_help_panel=panel(model, name),
        **extra,
    )
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[hint, said]
    )


def _kind(annotation: Any) -> Any:
    """Return what the parser of the command line makes of a value: lists stay text."""
    inner: list[Any] = [each for each in get_args(annotation) if each is not NoneType]
    if annotation in _PLAIN or annotation is Path or get_origin(annotation) is Literal:
        return annotation
    if NoneType in get_args(annotation):
        return _kind(inner[0])
    return str
