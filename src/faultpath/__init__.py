"""Audit whether a repair still helps when a fault reaches every module that shares its source.

The names below are public, and so are those with which a user's system is written (see
`docs/audit-your-own-system.md`). All other modules and names are private: they may change in any
version. Each name loads what it needs when it is first used, so importing this is quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from faultpath.core.version import __version__

if TYPE_CHECKING:
    from faultpath.api.audit import audit, audits
    from faultpath.api.checks import check, plan, trace
    from faultpath.api.comparing import compare
    from faultpath.api.designs import reversal_map, search, sensitivity
    from faultpath.api.judging import judge
    from faultpath.api.runs import Run, open_run
    from faultpath.api.systems import load_system
    from faultpath.core.errors import Stopped, UserError
    from faultpath.core.streams import generator
    from faultpath.trials.system import System

__all__ = [
    "Run",
    "Stopped",
    "System",
    "UserError",
    "__version__",
    "audit",
    "audits",
    "check",
    "compare",
    "generator",
    "judge",
    "load_system",
    "open_run",
    "plan",
    "reversal_map",
    "search",
    "sensitivity",
    "trace",
]

_HOMES = {
    "Run": "faultpath.api.runs",
    "Stopped": "faultpath.core.errors",
    "System": "faultpath.trials.system",
    "UserError": "faultpath.core.errors",
    "audit": "faultpath.api.audit",
    "audits": "faultpath.api.audit",
    "check": "faultpath.api.checks",
    "compare": "faultpath.api.comparing",
    "generator": "faultpath.core.streams",
    "judge": "faultpath.api.judging",
    "load_system": "faultpath.api.systems",
    "open_run": "faultpath.api.runs",
    "plan": "faultpath.api.checks",
    "reversal_map": "faultpath.api.designs",
    "search": "faultpath.api.designs",
    "sensitivity": "faultpath.api.designs",
    "trace": "faultpath.api.checks",
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
