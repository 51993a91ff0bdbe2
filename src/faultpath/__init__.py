"""Audit whether a repair still helps when a fault reaches every module that shares its source.

The names below are public, and so are those with which a user's system is written (see
`docs/audit-your-own-system.md`). All other modules and names are private: they may change in any
version. Each name loads what it needs when it is first used, so importing this is quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from faultpath.version import __version__

if TYPE_CHECKING:
    from faultpath.door.audit import audit, audits
    from faultpath.door.comparing import compare
    from faultpath.door.mapping import reversal_map
    from faultpath.door.planned import plan
    from faultpath.door.reproduced import ReproductionRun
    from faultpath.door.reproduction import reproduce
    from faultpath.door.run import Run, open_run
    from faultpath.door.systems import load_system
    from faultpath.errors import Stopped, UserError
    from faultpath.trials.system import System

__all__ = [
    "ReproductionRun",
    "Run",
    "Stopped",
    "System",
    "UserError",
    "__version__",
    "audit",
    "audits",
    "compare",
    "load_system",
    "open_run",
    "plan",
    "reproduce",
    "reversal_map",
]

_HOMES = {
    "ReproductionRun": "faultpath.door.reproduced",
    "Run": "faultpath.door.run",
    "Stopped": "faultpath.errors",
    "System": "faultpath.trials.system",
    "UserError": "faultpath.errors",
    "audit": "faultpath.door.audit",
    "audits": "faultpath.door.audit",
    "compare": "faultpath.door.comparing",
    "load_system": "faultpath.door.systems",
    "open_run": "faultpath.door.run",
    "plan": "faultpath.door.planned",
    "reproduce": "faultpath.door.reproduction",
    "reversal_map": "faultpath.door.mapping",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'faultpath' has no attribute {name!r}")
    import random

    drawn = random.getstate()
    try:
        found = getattr(import_module(_HOMES[name]), name)
    finally:
        random.setstate(drawn)  # some libraries draw from it when they are imported
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
