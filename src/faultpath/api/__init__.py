"""The front door: what `import faultpath` offers, and what the command line calls.

Calls that fewer scripts make have their public names here. A call runs, decides, writes a run
folder and returns what came out. It leaves threads, environment, working directory and random state
of its caller as they were.
"""

from typing import TYPE_CHECKING

from faultpath.core.lazy import load

if TYPE_CHECKING:
    from faultpath.api.audit import audits
    from faultpath.api.checks import trace
    from faultpath.core.errors import Stopped

__all__ = ["Stopped", "audits", "trace"]

_HOMES = {
    "Stopped": "faultpath.core.errors",
    "audits": "faultpath.api.audit",
    "trace": "faultpath.api.checks",
}


def __getattr__(name: str) -> object:
    return load(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
