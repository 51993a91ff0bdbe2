"""The front door: what `import faultpath` offers, and what the command line calls.

A call flies, decides, writes a run folder and returns what came out. It leaves threads, environment
and random state of its caller as they were. `check` and `trace` are offered here.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from faultpath.api.reviewing import check, trace

__all__ = ["check", "trace"]


def __getattr__(name: str) -> object:
    """Load the two when they are first used: every command comes through here."""
    if name not in __all__:
        raise AttributeError(f"module 'faultpath.api' has no attribute {name!r}")
    from faultpath.api import reviewing

    return getattr(reviewing, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
