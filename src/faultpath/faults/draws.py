"""The random numbers of a fault, the same for everyone that the fault strikes."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.streams import generators


@dataclass(frozen=True)
class Draws:
    """Random numbers addressed by cause, scene, seed and step, one row a scene.

    Two consumers, arms or blocks that share those four get the same numbers. Every call at one
    address starts the stream anew: calls with different shapes, and normal and uniform numbers,
    come from the same bits. `part` gives an independent address.
    """

    scenes: tuple[str, ...]
    seed: int
    cause: str
    _latest: dict[tuple[str, Any], tuple[int, NDArray[Any]]] = field(
        default_factory=dict[tuple[str, Any], tuple[int, NDArray[Any]]],
        init=False,
        repr=False,
        compare=False,
    )
    """What was last drawn: the other consumers of the same step ask for it again."""
    _parts: dict[str, "Draws"] = field(
        default_factory=dict[str, "Draws"], init=False, repr=False, compare=False
    )

    def normal(self, shape_per_scene: tuple[int, ...], step: int) -> NDArray[np.float64]:
        """Return standard normal numbers `[B, *shape_per_scene]`."""
        return self._rows("normal", shape_per_scene, step, lambda g: g.normal(size=shape_per_scene))

    def uniform(self, shape_per_scene: tuple[int, ...], step: int) -> NDArray[np.float64]:
        """Return uniform numbers in [0, 1), `[B, *shape_per_scene]`."""
        return self._rows("uniform", shape_per_scene, step, lambda g: g.random(shape_per_scene))

    def permutation(self, n: int, step: int) -> NDArray[np.int64]:
        """Return a permutation of `0 … n-1` for each scene, `[B, n]`."""
        return self._rows("permutation", n, step, lambda g: g.permutation(n))

    def part(self, index: int) -> "Draws":
        """Return the independent draws of one part of a composed intervention."""
        return self._beside(f"/{index}")

    def of_ask(self, ask: int) -> "Draws":
        """Return the independent draws of one ask within a step; the first has those of none."""
        return self._beside(f"?{ask}") if ask else self

    def _beside(self, suffix: str) -> "Draws":
        if suffix not in self._parts:
            self._parts[suffix] = Draws(self.scenes, self.seed, self.cause + suffix)
        return self._parts[suffix]

    def _rows(
        self, what: str, size: Any, step: int, draw: Callable[[np.random.Generator], Any]
    ) -> NDArray[Any]:
        known = self._latest.get((what, size))
        if known is not None and known[0] == step:
            return known[1]
        streams = generators(f"fault/{self.cause}", self.scenes, self.seed, step)
        drawn = np.stack([draw(stream) for stream in streams])
        self._latest[what, size] = (step, drawn)
        return drawn
