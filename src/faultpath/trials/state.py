"""What decides the trials of a system beside variant, scene, faults and seed."""

import inspect
import sys
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from faultpath.core.errors import SystemMistake
from faultpath.trials.arm import SystemSpec
from faultpath.trials.checks import paths_of
from faultpath.trials.code import Code, CodeState, Root, read_code
from faultpath.trials.declared import shown
from faultpath.trials.registry import factory_root
from faultpath.trials.system import System

_FLIES = Root("faultpath.trials.attempt")
"""What runs a trial, whichever system it is."""


def system_code(system: System, spec: SystemSpec) -> Code:
    """Return the code and data that `system`, built from `spec`, runs with, in their state.

    Its own modules and all that they import, faultpath's included, those of parts that the user
    named, the data files that it names, and what its `fingerprint()` says. Of an object that
    nothing can build again, that is the file of its class, or its source where it was typed into a
    notebook. `UserError` for a data file that cannot be read.
    """
    given, root = system.fingerprint(), None if spec.is_object else factory_root(spec)
    # A user's method returns what it likes.
    if not isinstance(given, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise SystemMistake(
            f"system '{system.name}': `fingerprint` returned {shown(given)}: it must return text"
        )
    classes: dict[str, Root] = {}
    for each in type(system).__mro__:
        module, name = sys.modules.get(each.__module__), each.__module__
        file = getattr(module, "__file__", None)
        if not file or not Path(file).is_file():
            continue
        if each is type(system) and spec.is_object:
            root = Root(name, Path(file))
        elif root is None or name != root.module:
            findable = getattr(module, "__spec__", None) is not None
            classes[name] = Root(name, None if findable else Path(file), of_system=False)
    if root is None:
        with suppress(OSError, TypeError):
            given = inspect.getsource(type(system)) + given
    parts = (factory_root(SystemSpec(name=str(name))) for name in paths_of(system, "parts"))
    code = read_code(
        ((root,) if root else ()) + (*classes.values(), *parts, _FLIES),
        data=map(Path, paths_of(system, "data_files")),
        base=root.path.parent if root and root.path else None,
        given=given,
    )
    return code if root else replace(code, main=None)


def source_state(spec: SystemSpec) -> CodeState:
    """Return the state of the code that building `spec` will load, without loading it."""
    return read_code((factory_root(spec), _FLIES)).state
