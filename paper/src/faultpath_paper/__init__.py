"""Tables, figures and claims of the paper, run with the quadrotor."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from faultpath_paper.reproduction import ReproductionRun, read_reproduction, reproduce

__all__ = ["ReproductionRun", "read_reproduction", "reproduce"]


def __getattr__(name: str) -> object:
    """Load a public name when it is first used, so that naming the package loads no torch."""
    if name not in __all__:
        raise AttributeError(f"module 'faultpath_paper' has no attribute {name!r}")
    return getattr(import_module("faultpath_paper.reproduction"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
