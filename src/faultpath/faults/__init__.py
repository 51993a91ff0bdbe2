"""Interventions on readings, and faults that say where and when they act.

The names of `faultpath.faults.public` load when one is first used: reading text needs none of them.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from faultpath.faults.public import *  # noqa: F403 - for type checkers; `__all__` lists them


def __getattr__(name: str) -> object:
    import faultpath.faults.public as public

    return getattr(public, name)


def __dir__() -> list[str]:
    import faultpath.faults.public as public

    return public.__all__
