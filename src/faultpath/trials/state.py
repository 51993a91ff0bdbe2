"""What decides the trials of a system beside variant, scene, faults and seed."""

import sys
from pathlib import Path

from faultpath.code import Code, CodeState, Root, read_code
from faultpath.trials.arm import SystemSpec
from faultpath.trials.checks import fingerprint_of
from faultpath.trials.registry import factory_root
from faultpath.trials.system import System

_FLIES = Root("faultpath.execution.attempt")
"""What runs a trial, whichever system it is."""


def system_code(system: System, spec: SystemSpec) -> Code:
    """Return the code and data that `system`, built from `spec`, flies with, in their state.

    Its own modules and all that they import, faultpath's included, the data files that it names,
    and what its `fingerprint()` says. `UserError` for a data file that cannot be read.
    """
    root = factory_root(spec)
    return read_code(
        (root, *_classes(system, root), _FLIES),
        data=map(Path, system.data_files),
        base=None if root.path is None else root.path.parent,
        given=fingerprint_of(system),
    )


def source_state(spec: SystemSpec) -> CodeState:
    """Return the state of the code that building `spec` will load, without loading it."""
    return read_code((factory_root(spec), _FLIES)).state


def _classes(system: System, root: Root) -> tuple[Root, ...]:
    """Return the modules of the system's classes, which its factory may have found anywhere."""
    found: dict[str, Root] = {}
    for each in type(system).__mro__:
        module = sys.modules.get(each.__module__)
        file = getattr(module, "__file__", None)
        if module is None or file is None or each.__module__ == root.module:
            continue
        findable = getattr(module, "__spec__", None) is not None
        name = each.__module__
        found[name] = Root(name, None if findable else Path(file), of_system=False)
    return tuple(found.values())
