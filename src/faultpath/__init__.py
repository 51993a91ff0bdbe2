"""Audit whether a repair still helps when a fault reaches every module that shares its source.

The names below are public, and so are those of `faultpath.api`, those with which a user's system is
written (see `docs/audit-your-own-system.md`) and those of `faultpath.plugin`. All other modules and
names are private: they may change in any version. Each name loads what it needs when it is first
used, so importing this is quick.
"""

from typing import TYPE_CHECKING

from faultpath import api as api
from faultpath.core import __version__
from faultpath.core.lazy import load

if TYPE_CHECKING:
    from faultpath.api.audit import audit, map, scan
    from faultpath.api.checks import check
    from faultpath.api.judging import judge
    from faultpath.api.runs import Run, compare, open_run
    from faultpath.api.systems import load_system
    from faultpath.core.errors import UserError
    from faultpath.core.streams import generator
    from faultpath.system.system import System

__all__ = [
    "Run",
    "System",
    "UserError",
    "__version__",
    "audit",
    "check",
    "compare",
    "generator",
    "judge",
    "load_system",
    "map",
    "open_run",
    "scan",
]

_HOMES = {
    "Run": "faultpath.api.runs",
    "System": "faultpath.system.system",
    "UserError": "faultpath.core.errors",
    "audit": "faultpath.api.audit",
    "check": "faultpath.api.checks",
    "compare": "faultpath.api.runs",
    "generator": "faultpath.core.streams",
    "judge": "faultpath.api.judging",
    "load_system": "faultpath.api.systems",
    "map": "faultpath.api.audit",
    "open_run": "faultpath.api.runs",
    "scan": "faultpath.api.audit",
}


def __getattr__(name: str) -> object:
    return load(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
