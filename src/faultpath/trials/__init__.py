"""Treatments over identical scenes: systems, studies, outcomes and their pairing.

The names of `faultpath.trials.public` load when one is first used: a question needs none of them.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from faultpath.trials.public import *  # noqa: F403 - for type checkers; `__all__` lists them


def __getattr__(name: str) -> object:
    import faultpath.trials.public as public

    return getattr(public, name)


def __dir__() -> list[str]:
    import faultpath.trials.public as public

    return public.__all__
