"""From a call or a command line to a question, the system that it is about, and who is told."""

import inspect
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Any, TypeVar

from faultpath.api.display import Display, display
from faultpath.api.systems import Chosen, choose
from faultpath.trials import Library, System, library_of
from faultpath.trials.question import Request, ask

_Call = TypeVar("_Call", bound=Callable[..., Any])
_Asked = TypeVar("_Asked", bound=Request)


def asks(model: type[Request]) -> Callable[[_Call], _Call]:
    """Give a function whose last parameter is `**given` the signature and the help of a model."""

    def described(function: _Call) -> _Call:
        signature = inspect.signature(function)
        kept = [each for each in signature.parameters.values() if each.kind != each.VAR_KEYWORD]
        fields = [
            inspect.Parameter(
                name,
                inspect.Parameter.KEYWORD_ONLY,
                default=inspect.Parameter.empty
                if field.is_required()
                else field.get_default(call_default_factory=True),
                annotation=field.annotation,
            )
            for name, field in model.model_fields.items()
            if name not in signature.parameters
        ]
        told = "\n".join(
            textwrap.fill(
                f"{name}: {field.description}",
                96,
                initial_indent=" " * 8,
                subsequent_indent=" " * 12,
            )
            for name, field in model.model_fields.items()
            if name not in signature.parameters
        )
        vars(function)["__signature__"] = signature.replace(parameters=[*kept, *fields])
        function.__doc__ = (function.__doc__ or "").replace("        **given: ...", told)
        return function

    return described


@dataclass(frozen=True)
class Begun:
    """A system that is built, with the scenes that were asked for."""

    chosen: Chosen
    library: Library
    told: Display


def begin(
    call: str,
    system: str | PathLike[str] | System,
    asked: Request,
    progress: bool | Display,
) -> Begun:
    """Build the system of a question.

    Raises as `choose`, and for a library that does not exist. `call` is the name of the function.
    """
    how: dict[str, Any] = vars(asked)
    executor = how.get("executor", "local")
    chosen = choose(system, asked.options, how.get("workers"), asked.arms, executor)
    library = library_of(chosen.system, asked.library)
    said = {"system": chosen.spec.name, **asked.model_dump(exclude_unset=True)}
    told = display(progress, call, said | {"options": chosen.spec.options})
    return Begun(chosen, library, told)


def commanded(progress: bool | Display) -> bool:
    """Return whether the command line made a call."""
    return isinstance(progress, Display) and progress.is_command


def asked_for(model: type[_Asked], given: Mapping[str, object], progress: bool | Display) -> _Asked:
    """Return the question of a call; `UserError` for what does not fit, as its caller names it."""
    return ask(model, given, commanded(progress))
