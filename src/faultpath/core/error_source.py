"""Finds whether an error comes from a user's system or from faultpath.

A traceback is read from its innermost frame outward. Frames of the standard library and of
installed packages are skipped, because they only do what their caller asks. The first other frame
decides.
"""

import os
import re
import sys
import traceback
from collections.abc import Callable, Iterator
from inspect import unwrap
from pathlib import Path
from typing import Any, cast

from faultpath.core.errors import SystemMistake, UserError
from faultpath.core.text import near, one_line
from faultpath.core.trees import kind_of, ours
from faultpath.core.validation_messages import misfit_of

_systems: set[str] = set()
"""Folders of loaded systems; those in installed packages would be skipped otherwise."""

_MISUSE = (TypeError, ValueError, AttributeError, LookupError)
"""Errors that an argument of the wrong kind causes."""


def note_system(file: str) -> None:
    """Note that the code beside `file` is a system's, even in an installed package.

    The standard library is never taken for a system, even where a user names it by mistake.
    """
    real = os.path.realpath(file)
    if kind_of(Path(real)) != "standard":
        _systems.add(os.path.dirname(real) + os.sep)


def location_of(function: Callable[..., Any]) -> str:
    """Return file and line of a function; empty for any but a user's own."""
    inner: Any = unwrap(function)
    code = getattr(inner, "__code__", None)
    if code is None or ours(inner.__module__):
        return ""
    return f"{near(code.co_filename)}, line {code.co_firstlineno}"


def mistake_in(function: Callable[..., Any], sentence: str) -> SystemMistake:
    """Return what is wrong with a function of a system, with its file and line."""
    mistake = SystemMistake(sentence)
    mistake.location = location_of(function)
    return mistake


def location(error: BaseException) -> str:
    """Return the innermost line of a system's own code in a traceback; empty if there is none."""
    return next(filter(None, _frames(error)), "")


def location_in(report: str) -> str:
    """Return `location` of a formatted traceback, as it comes from a worker."""
    frames = re.findall(r'^  File "(.+?)", line (\d+)', report, re.MULTILINE)
    own = (f"{near(file)}, line {line}" for file, line in reversed(frames) if not _skipped(file))
    return next(own, "")


def described(error: BaseException) -> str:
    """Return kind and message of an error, in one line.

    It is stored with outcomes, and so names no path: those differ from machine to machine.
    """
    pydantic, invalid = sys.modules.get("pydantic"), cast(Any, error)
    if pydantic is not None and isinstance(error, pydantic.ValidationError):
        return one_line(f"{invalid.title} cannot be made: {misfit_of(invalid)}")
    try:
        message = error.msg if isinstance(error, SyntaxError) else str(error)
    except Exception:  # an error of the system's own may fail even at that
        message = ""
    return one_line(f"{type(error).__name__}: {message}" if message else type(error).__name__)


def located(error: UserError) -> UserError:
    """Note in a `SystemMistake` the line of the system's code that caused it."""
    if isinstance(error, SystemMistake) and not error.location:
        error.location = location(error)
    return error


def explained(error: BaseException) -> UserError | None:
    """Return the error to show to the author of a system; `None` for one of faultpath's own.

    An error raised in the system's code is its author's. Where that code called faultpath's, and
    the error is of a kind that a wrong argument causes, either may be at fault, and it says so.
    """
    if isinstance(error, UserError):
        return located(error)
    if isinstance(error.__cause__, StopIteration):  # the system's own, let through a generator
        error = error.__cause__
    own, innermost = location(error), next(_frames(error), "")
    if not own or not (innermost or isinstance(error, (SystemExit, *_MISUSE))):
        return None
    what = described(error)
    if isinstance(error, SystemExit):
        advice = f"the system ends the program ({what}); let it raise an error instead"
    elif innermost:
        advice = f"{what}; correct the system there, or see all of it with --traceback"
    else:
        advice = (
            f"faultpath fails on what it is handed there ({what}); correct the call, or see with "
            "--traceback whether the fault is faultpath's"
        )
    mistake = SystemMistake(advice)
    mistake.location, mistake.__cause__ = own, error
    return mistake


def _frames(error: BaseException) -> Iterator[str]:
    if isinstance(error, SyntaxError) and error.filename and not _skipped(error.filename):
        yield f"{near(error.filename)}, line {error.lineno or 1}"
    for frame, line in reversed(list(traceback.walk_tb(error.__traceback__))):
        file = os.path.realpath(frame.f_code.co_filename)
        if file.startswith(_our_folders()):
            yield ""
        elif not _skipped(frame.f_code.co_filename):
            yield f"{near(file)}, line {line}"


def _skipped(name: str) -> bool:
    # Code without a file: frozen modules, generated methods, what packages compiled from Cython.
    if name.startswith("<") or (name.endswith((".pyx", ".pxi")) and not os.path.exists(name)):
        return True
    file = os.path.realpath(name)
    if file.startswith(tuple(_systems)):
        return False
    return file.startswith(_our_folders()) or kind_of(Path(file)) != "local"


def _our_folders() -> tuple[str, ...]:
    loaded = ((name, module) for name, module in tuple(sys.modules.items()) if "." not in name)
    files = (getattr(module, "__file__", None) for name, module in loaded if ours(name))
    return tuple(os.path.dirname(os.path.realpath(file)) + os.sep for file in files if file)
