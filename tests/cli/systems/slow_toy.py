"""The toy of the examples in small blocks, slowed down while a file exists."""

import importlib.util
import time
from pathlib import Path

from faultpath.system import System

_PLACE = Path(__file__).resolve().parents[3] / "examples" / "toy.py"
_SPEC = importlib.util.spec_from_file_location("toy_of_the_examples", _PLACE)
assert _SPEC is not None
assert _SPEC.loader is not None
toy = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(toy)


class SlowToy(toy.Toy):
    block_size = 2

    def __init__(self, gate: str) -> None:
        self._gate = Path(gate)

    def run(self, variant, scenes, taps, seed):
        if self._gate.exists():
            time.sleep(0.3)
        return super().run(variant, scenes, taps, seed)


class Broken(toy.Toy):
    """Raises an error in one scene, or in all."""

    def __init__(self, where: str = "") -> None:
        self._where = where

    def run(self, variant, scenes, taps, seed):
        if any(scene.startswith(self._where) for scene in scenes):
            raise ZeroDivisionError("the [cart] has no wheels")
        return super().run(variant, scenes, taps, seed)


def create(gate: str) -> System:
    return SlowToy(gate)


def broken(where: str) -> System:
    return Broken(where)
