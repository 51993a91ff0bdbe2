"""What an environment of Gymnasium is: how it is made, and whose code moves it."""

import re
import sys
from types import ModuleType
from typing import Any

from faultpath.trials.code import release

_PLACE = re.compile(r"(?<=faultpath_system_)\w*(?=:)| at 0x[0-9a-f]+")
"""Where a system's file lies, which its module is called after, and where in memory a function is:
both differ from machine to machine."""


def identity(env: Any) -> str:
    """Return how an environment is made, and the packages that its class computes with."""
    kinds = type(env.unwrapped).__mro__
    spaces = [
        vars(sys.modules[kind.__module__]) for kind in kinds if kind.__module__ in sys.modules
    ]
    used = {
        v.__name__.partition(".")[0]
        for s in spaces
        for v in s.values()
        if isinstance(v, ModuleType)
    }
    versions = {name: found for name in sorted(used) if (found := release(name))}
    return f"{_PLACE.sub('', str(env.spec))} {versions}"


def code(env: Any) -> tuple[str, ...]:
    """Return the classes of an environment and its wrappers that are not Gymnasium's own.

    What is registered under an id is imported by nobody, and its code counts all the same.
    """
    parts: list[Any] = [env]
    while hasattr(parts[-1], "env"):
        parts.append(parts[-1].env)
    names = ((part.__class__.__module__, part.__class__.__name__) for part in parts)
    return tuple(dict.fromkeys(f"{place}:{name}" for place, name in names if _findable(place)))


def _findable(module: str) -> bool:
    """Return whether a module can be imported by its name and is neither Gymnasium's nor the file
    of a system, which count already."""
    ours = module.partition(".")[0] == "gymnasium" or module.startswith("faultpath_system_")
    return not ours and getattr(sys.modules.get(module), "__spec__", None) is not None
