"""Base class of interventions, and the random numbers that they draw."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from math import sqrt
from typing import Any, ClassVar, Self, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict
from typing_extensions import override

from faultpath.core.arrays import Array, misfit
from faultpath.core.streams import generators
from faultpath.interface import Channel

Memory: TypeAlias = Any
"""Value that an intervention carries from step to step: an array, a tuple or `None`; never changed
in place."""


@dataclass(frozen=True)
class Draws:
    """Random numbers addressed by cause, scene, seed and step, one row a scene.

    Readers, treatments and blocks that share these four get the same numbers. Every call restarts
    the stream of its address, so calls with different shapes, and normal and uniform numbers, come
    from the same bits. `beside` gives an independent address.

    With `own`, numbers are a mixture of the cause's and of `own`: two draws of one cause with the
    loadings a and b have the correlation a * b (one-factor model; uniform numbers through the
    Gaussian copula). Permutations are always the cause's.
    """

    scenes: tuple[str, ...]
    seed: int
    cause: str
    loading: float = 1.0
    """Share of the cause in a normal number, from -1 to 1."""
    own: "Draws | None" = None
    _cache: dict[Any, Any] = field(
        default_factory=dict[Any, Any], init=False, repr=False, compare=False
    )
    """Latest numbers, which all readers of a step need; and draws of `beside`."""

    def normal(self, shape_per_scene: tuple[int, ...], step: int) -> NDArray[np.float64]:
        """Return standard normal numbers `[B, *shape_per_scene]`."""
        common = self._rows(
            "normal", shape_per_scene, step, lambda g: g.normal(size=shape_per_scene)
        )
        if self.own is None:
            return common
        rest = sqrt(1 - self.loading**2)
        return self.loading * common + rest * self.own.normal(shape_per_scene, step)

    def uniform(self, shape_per_scene: tuple[int, ...], step: int) -> NDArray[np.float64]:
        """Return uniform numbers in [0, 1), `[B, *shape_per_scene]`."""
        if self.own is not None:
            from scipy.special import (
                ndtr,  # only here: it takes longer to import than everything else
            )

            return ndtr(self.normal(shape_per_scene, step))
        return self._rows("uniform", shape_per_scene, step, lambda g: g.random(shape_per_scene))

    def permutation(self, n: int, step: int) -> NDArray[np.int64]:
        """Return a permutation of `0 … n-1` for each scene, `[B, n]`."""
        return self._rows("permutation", n, step, lambda g: g.permutation(n))

    def beside(self, suffix: str) -> "Draws":
        """Return independent draws: suffix `/N` for a part, `?N` for a further request in a
        step."""
        if suffix not in self._cache:
            own = None if self.own is None else self.own.beside(suffix)
            cause = self.cause + suffix
            self._cache[suffix] = Draws(self.scenes, self.seed, cause, self.loading, own)
        return self._cache[suffix]

    def _rows(
        self, what: str, size: Any, step: int, draw: Callable[[np.random.Generator], Any]
    ) -> NDArray[Any]:
        cached = self._cache.get((what, size))
        if cached is not None and cached[0] == step:
            return cached[1]
        streams = generators(f"fault/{self.cause}", self.scenes, self.seed, step)
        numbers = np.stack([draw(stream) for stream in streams])
        self._cache[what, size] = (step, numbers)
        return numbers


@dataclass(frozen=True, slots=True)
class Moment:
    """The time at which an intervention acts."""

    step: int
    """Control step, from 0."""
    elapsed: int
    """Steps since the onset, negative before it."""
    dt_s: float
    """Length of a control step, s."""
    draws: Draws


class Intervention(BaseModel, ABC):
    """One way of changing a reading, pure and batched over scenes.

    A reading is an array `[B, ...]` of NumPy, torch or any array-API namespace; the value has its
    shape, dtype and device. A step never waits for an accelerator. Neither the reading nor the
    memory is changed in place. `apply` is called at every delivery until the fault is over, even
    before the onset, so that a delay has past readings; the tap uses its value in the window only.

    A subclass has a literal `kind` and is one of `faultpath.faults.kinds.Listed`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    value_field: ClassVar[str | None] = None
    """Field that takes VALUE in fault text `CHANNEL:KIND=VALUE`: the first after `kind`. `None`:
    there is none, and the text is `CHANNEL:KIND`."""
    random: ClassVar[bool] = False
    """Whether it draws errors, so that those of several channels can be correlated."""
    phrase: ClassVar[str] = ""
    """Its effect on the reading in a few words; a field's name in braces stands for its value."""

    @classmethod
    @override
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        cls.value_field = next((name for name in cls.model_fields if name != "kind"), None)

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the memory before the first `apply`, at the first delivery."""
        return None

    @abstractmethod
    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the value for the reader, and the memory for the next call."""

    def is_random(self) -> bool:
        """Return whether it or a part of it draws errors."""
        return self.random

    def words(self) -> str:
        """Return its effect in a few words."""
        return self.phrase.format_map({name: number(value) for name, value in self})

    def resolved(self, channel: Channel) -> Self:
        """Return the intervention with its defaults from the channel's declaration filled in."""
        return self

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Return why it cannot act on one scene's reading of `shape`, or `None`.

        By default it checks the fields that hold several numbers.
        """
        kind: str = type(self).model_fields["kind"].default
        labels = {self.value_field: kind}  # as fault text has it: `offset=0.1/0`
        for name, value in self:
            if isinstance(value, tuple):
                numbers = cast("tuple[Any, ...]", value)
                if wrong := misfit(labels.get(name, name), numbers, shape):
                    return wrong
        return None


def number(value: Any) -> str:
    """Return a number or nested tuple of numbers in short form, and any other value as text."""
    if isinstance(value, tuple):
        return "(" + ", ".join(map(number, cast("tuple[Any, ...]", value))) + ")"
    return f"{value:g}" if isinstance(value, float) else str(value)
