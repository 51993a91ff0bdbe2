"""Flags of the verbs: the fields of a question, and the options of the system that is named."""

import inspect
from collections.abc import Callable, Sequence
from difflib import get_close_matches
from functools import wraps
from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, get_args, get_origin

import typer
from typer.models import OptionInfo

from faultpath.cli.options import literal, path
from faultpath.core.errors import UserError
from faultpath.run.question import ADVANCED, Flag, UserQuestion, flag

if TYPE_CHECKING:
    from faultpath.system.options import Option

_Verb = TypeVar("_Verb", bound=Callable[..., Any])
_KEYWORD = inspect.Parameter.KEYWORD_ONLY
_PLAIN = (str, int, float, bool)
_SHORT = 24
"""Letters of choices that stand where the type would."""
_DEST = "system_"
"""Before the names of the system's options, which may be those of the verb's own."""


def takes(model: type[UserQuestion], *without: str) -> Callable[[_Verb], _Verb]:
    """Give a verb the flags of a model.

    The verb has a last parameter `**arguments`, which gets what the line says, by the names of the
    model; what it does not say is left to the model. Fields named in `without` have no flag.
    """
    fields = {name: field for name, field in model.model_fields.items() if name not in without}

    def decorate(verb: _Verb) -> _Verb:
        @wraps(verb)
        def command(context: typer.Context, **line: Any) -> Any:
            values = {name: line.pop(name) for name in fields}
            # Flags of a system are added to `options`, whether the line has `--set` or not.
            arguments = {
                name: value
                for name, value in values.items()
                if _is_said(context, name) or (name == "options" and value)
            }
            for name in arguments:
                if fields[name].default is True:
                    arguments[name] = not arguments[name]
            if "options" in arguments:
                pairs, arguments["options"] = arguments["options"] or (), {}
                for pair in pairs:
                    key, separator, value = pair.partition("=")
                    if not separator or not key:
                        raise UserError(
                            f"--set {pair!r} is not of the form key=value, for example wind=L3."
                        )
                    if key in arguments["options"]:
                        raise UserError(f"the options name '{key}' twice: give it once.")
                    arguments["options"][key] = value
            return verb(**line, **arguments)

        own = inspect.signature(verb).parameters.values()
        every = [parameter for parameter in own if parameter.kind != parameter.VAR_KEYWORD]
        every += [_parameter(model, name) for name in fields]
        every.sort(key=_advanced)
        # Arguments go before, then what is required; typer keeps the order within a panel.
        every.append(inspect.Parameter("context", _KEYWORD, annotation=typer.Context))
        parameters = [parameter.replace(kind=_KEYWORD) for parameter in every]
        vars(command)["__signature__"] = inspect.Signature(parameters)
        # Its signature is the model's from here on, which no type can say.
        return command  # pyright: ignore[reportReturnType]

    return decorate


def _is_said(context: typer.Context, name: str) -> bool:
    """Return whether the line has an option, where it does not stand at its default."""
    source = context.get_parameter_source(name)
    return source is not None and source.name != "DEFAULT"


def _advanced(parameter: inspect.Parameter) -> bool:
    """Return whether a parameter is an option that stands last in the help."""
    notes = getattr(parameter.annotation, "__metadata__", ())
    return any(getattr(note, "rich_help_panel", None) == ADVANCED for note in notes)


def _parameter(model: type[UserQuestion], name: str) -> inspect.Parameter:
    """Return the option of a field: its type, default, help and heading."""
    field = model.model_fields[name]
    notes = [note for note in field.metadata if isinstance(note, Flag)]
    several = any(note.several for note in notes)
    kind: Any = field.annotation
    if NoneType in get_args(kind):
        kind = next(part for part in get_args(kind) if part is not NoneType)
    if not (kind in _PLAIN or kind is Path or get_origin(kind) is Literal):
        kind = str  # lists stay text
    default: Any = field.default
    if field.is_required():
        default = inspect.Parameter.empty
    elif several or default in ("", (), None):
        default = None
    elif isinstance(default, tuple):
        default = ",".join(f"{value:g}" for value in field.default)
    elif default is True:
        default = False
    owners = (owner for owner in model.__mro__ if name in vars(owner).get("__annotations__", {}))
    panels = [note.panel for note in notes if note.panel]
    panels += [owner.panel for owner in owners if issubclass(owner, UserQuestion)]
    text = field.description or ""
    option = typer.Option(
        flag(model, name),
        help=f"Do not {text[0].lower()}{text[1:]}" if field.default is True else text,
        rich_help_panel=panels[0] or None,
        parser=path if kind is Path else None,
    )
    hint: Any = list[str] if several else kind
    annotation = Annotated[hint | None if default is None else hint, option]
    return inspect.Parameter(name, _KEYWORD, default=default, annotation=annotation)


def flags_of(verb: Callable[..., Any]) -> set[str]:
    """Return the flags that a verb takes."""
    own = {"--help"}
    for parameter in inspect.signature(verb).parameters.values():
        for note in getattr(parameter.annotation, "__metadata__", ()):
            if isinstance(note, OptionInfo):
                named = note.default if isinstance(note.default, str) else ""
                own |= {named or f"--{parameter.name}", *(note.param_decls or ())}
    return own


def with_system_flags(
    name: str, verb: Callable[..., Any], arguments: Sequence[str]
) -> Callable[..., Any]:
    """Return the verb `name` with the flags of the system that its arguments begin with.

    The verb has an option `options`, which takes what the flags say. A user's system is imported,
    but only where the line asks for help or holds a flag that the verb itself has not got.
    `UserError` for a flag that neither of the two has, and for a system that cannot be asked.
    """
    own, signature = flags_of(verb), inspect.signature(verb)
    if "--" in arguments:
        arguments = arguments[: arguments.index("--")]
    helps = "--help" in arguments
    flags = {part.partition("=")[0] for part in arguments if part.startswith("--")} - own
    if not (flags or helps) or arguments[0] == "--help":
        return verb
    from faultpath.run.registry import system_options

    system, options = "" if arguments[0].startswith("-") else arguments[0], ()
    try:
        options = system_options(system) if system else ()
    except (Exception, SystemExit):
        if not helps:
            raise
    named = {f"--{option.name.replace('_', '-')}": option for option in options}
    added = {name: option for name, option in named.items() if name not in own}
    for unknown in sorted(flags - {*added}) if not helps else ():
        close = get_close_matches(unknown, [*own, *added], n=1)
        hint = f"did you mean {close[0]}? " if close else ""
        takes = "those of a system stand after its name"
        if system:
            takes = f"system {system!r} takes {', '.join(added) or 'none of its own'}"
        raise UserError(
            f"there is no option {unknown}: {hint}`faultpath {name} --help` shows those of the "
            f"command, and {takes}."
        )

    @wraps(verb)
    def extended(**arguments: Any) -> Any:
        pairs = list(arguments.pop("options") or ())
        for option in added.values():
            value = arguments.pop(_DEST + option.name)
            pairs += [] if value is None else [f"{option.name}={value}"]
        return verb(**arguments, options=pairs)

    every = [*signature.parameters.values()]
    every += [_system_option(system, spelling, option) for spelling, option in added.items()]
    vars(extended)["__signature__"] = signature.replace(parameters=every)
    return extended


def _system_option(system: str, spelling: str, option: "Option") -> inspect.Parameter:
    choices, text = "|".join(option.choices), option.help.rstrip(".")
    short = 0 < len(choices) <= _SHORT
    if choices and not short:
        listed = ", ".join(option.choices)
        text += f": {listed}" if text else f"One of {listed}"
    if option.default:
        text += f"{'; d' if text else 'D'}efault {option.default}"
    shown = typer.Option(
        spelling,
        metavar=f"<{choices if short else option.kind}>",
        help=f"{text}." if text else None,
        rich_help_panel=literal(f"Options of {system}"),
    )
    annotation = Annotated[str | None, shown]
    name = _DEST + option.name
    return inspect.Parameter(name, _KEYWORD, default=None, annotation=annotation)
