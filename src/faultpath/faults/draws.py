"""The random numbers of a fault, the same for everyone that the fault reaches."""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.core.streams import generators


@dataclass(frozen=True)
class Draws:
    """Random numbers addressed by cause, scene, seed and step, one row a scene.

    Two consumers, arms or blocks that share those four get the same numbers. Every call at one
    address starts the stream anew: calls with different shapes, and normal and uniform numbers,
    come from the same bits. `part` gives an independent address.

    With `own`, numbers are made of those of the cause and of its own: two draws of one cause with
    the loadings a and b have the correlation a * b (one-factor model; uniform numbers through the
    Gaussian copula). Permutations are of the cause.
    """

    scenes: tuple[str, ...]
    seed: int
    cause: str
    loading: float = 1.0
    """Share of the cause in a normal number, from -1 to 1."""
    own: "Draws | None" = None
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
        drawn = self._rows(
            "normal", shape_per_scene, step, lambda g: g.normal(size=shape_per_scene)
        )
        if self.own is None:
            return drawn
        rest = sqrt(1 - self.loading**2)
        return self.loading * drawn + rest * self.own.normal(shape_per_scene, step)

    def uniform(self, shape_per_scene: tuple[int, ...], step: int) -> NDArray[np.float64]:
        """Return uniform numbers in [0, 1), `[B, *shape_per_scene]`."""
        if self.own is not None:
            from scipy.special import ndtr  # only here: it takes longer to load than all else

            return ndtr(self.normal(shape_per_scene, step))
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
            own = None if self.own is None else self.own._beside(suffix)
            cause = self.cause + suffix
            self._parts[suffix] = Draws(self.scenes, self.seed, cause, self.loading, own)
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
