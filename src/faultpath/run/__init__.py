"""Treatments run over identical scenes: plans, workers, the store, trials and their pairing.

The names of `faultpath.run.public` load when one is first used: a question needs none of them.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from faultpath.run.public import *  # noqa: F403 - for type checkers; `__all__` lists them


def __getattr__(name: str) -> object:
    import faultpath.run.public as public

    return getattr(public, name)


def __dir__() -> list[str]:
    import faultpath.run.public as public

    return public.__all__
