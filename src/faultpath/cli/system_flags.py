"""The options of a system as flags of the verbs that take one.

Which system a command line names decides which flags there are, so the verb gets them before the
line is parsed. A user's system is imported for that, but only where the line asks for help or
holds a flag that the verb itself has not got.
"""

import inspect
from collections.abc import Callable, Iterable, Sequence
from difflib import get_close_matches
from functools import wraps
from typing import Annotated, Any, Protocol

import typer
from typer.models import OptionInfo

from faultpath.cli.verbs import literal
from faultpath.core.errors import UserError

_HELP = "--help"
_SHORT = 24
"""Letters of choices that stand where the type would."""
_DEST = "system_"
"""Before the names of the system's options, which may be those of the verb's own."""


class _Option(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def help(self) -> str: ...
    @property
    def choices(self) -> tuple[str, ...]: ...
    @property
    def default(self) -> str | None: ...


def with_system_flags(
    name: str, verb: Callable[..., Any], arguments: Sequence[str]
) -> Callable[..., Any]:
    """Return the verb `name` with the flags of the system that its arguments name.

    The verb has an argument `system` and an option `options`, which takes what the flags say.
    `UserError` for a flag that neither of the two has, and for a system that cannot be asked.
    """
    own = _flags(verb)
    arguments = arguments[: arguments.index("--")] if "--" in arguments else arguments
    asked = {part.partition("=")[0] for part in arguments if part.startswith("--")} - {*own, _HELP}
    system = _system(arguments, own)
    if system is None or not (asked or _HELP in arguments):
        return verb
    options = [each for each in _options(system, _HELP in arguments) if _flag(each) not in own]
    if _HELP not in arguments:
        _check(asked, name, system, options, own)
    return _extended(verb, system, options)


def _check(
    asked: Iterable[str],
    verb: str,
    system: str,
    options: Sequence[_Option],
    own: Iterable[str],
) -> None:
    known = [_flag(option) for option in options]
    for flag in sorted(asked):
        if flag not in known:
            close = get_close_matches(flag, [*own, *known], n=1)
            hint = f"did you mean {close[0]}? " if close else ""
            raise UserError(
                f"there is no option {flag}: {hint}`faultpath {verb} --help` shows those of the "
                f"command, and system {system!r} takes {', '.join(known) or 'none of its own'}."
            )


def _flag(option: _Option) -> str:
    return f"--{option.name.replace('_', '-')}"


def _options(system: str, forgiving: bool) -> Sequence[_Option]:
    from faultpath.trials import system_options

    try:
        return system_options(system)
    except (Exception, SystemExit):
        if forgiving:
            return ()
        raise


def _flags(verb: Callable[..., Any]) -> dict[str, bool]:
    found: dict[str, bool] = {}
    for name, parameter in inspect.signature(verb).parameters.items():
        for note in getattr(parameter.annotation, "__metadata__", ()):
            if isinstance(note, OptionInfo):
                named = note.default if isinstance(note.default, str) else ""
                flags = (
                    (*named.split("/"), *(note.param_decls or ()))
                    if named
                    else (f"--{_dashed(name)}",)
                )
                found |= dict.fromkeys(flags, parameter.annotation.__origin__ is not bool)
    return found


def _dashed(name: str) -> str:
    return name.strip("_").replace("_", "-")


def _system(arguments: Sequence[str], own: dict[str, bool]) -> str | None:
    value = False
    for part in arguments:
        if value or part.startswith("-"):
            value = not value and "=" not in part and part != _HELP and own.get(part, True)
        else:
            return part
    return None


def _extended(
    verb: Callable[..., Any], system: str, options: Sequence[_Option]
) -> Callable[..., Any]:
    @wraps(verb)
    def extended(**given: Any) -> Any:
        pairs = list(given.pop("options") or ())
        for option in options:
            value = given.pop(_DEST + option.name)
            pairs += [] if value is None else [f"{option.name}={value}"]
        return verb(**given, options=pairs)

    added = [
        inspect.Parameter(
            _DEST + option.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=None,
            annotation=Annotated[str | None, _shown(option, system)],
        )
        for option in options
    ]
    signature = inspect.signature(verb)
    extended.__dict__["__signature__"] = signature.replace(
        parameters=[*signature.parameters.values(), *added]
    )
    return extended


def _shown(option: _Option, system: str) -> OptionInfo:
    choices = "|".join(option.choices)
    short = 0 < len(choices) <= _SHORT
    said = option.help.rstrip(".")
    if choices and not short:
        said += f": {', '.join(option.choices)}" if said else f"One of {', '.join(option.choices)}"
    if option.default:
        said += f"{'; d' if said else 'D'}efault {option.default}"
    return typer.Option(
        _flag(option),
        metavar=f"<{choices}>" if short else "<str>",
        help=f"{said}." if said else None,
        rich_help_panel=literal(f"Options of {system}"),
    )
