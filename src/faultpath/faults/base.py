"""The base class of interventions, and the random numbers that they draw."""

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
"""Value that an intervention carries from step to step: an array, a tuple or `None`; never written
to."""


@dataclass(frozen=True)
class Draws:
    """Random numbers addressed by cause, scene, seed and step, one row a scene.

    Two readers, treatments or blocks that share those four get the same numbers. Every call at one
    address starts the stream anew: calls with different shapes, and normal and uniform numbers,
    come from the same bits. `beside` gives an independent address.

    With `own`, numbers mix those of the cause with those of `own`: two draws of one cause with the
    loadings a and b have the correlation a * b (one-factor model; uniform numbers through the
    Gaussian copula). Permutations are of the cause.
    """

    scenes: tuple[str, ...]
    seed: int
    cause: str
    loading: float = 1.0
    """Share of the cause in a normal number, from -1 to 1."""
    own: "Draws | None" = None
    _kept: dict[Any, Any] = field(
        default_factory=dict[Any, Any], init=False, repr=False, compare=False
    )
    """Numbers drawn last, which the other readers of a step need too; and draws of `beside`."""

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

    def beside(self, suffix: str) -> "Draws":
        """Return independent draws: `/N` those of a part, `?N` those of a further ask in a step."""
        if suffix not in self._kept:
            own = None if self.own is None else self.own.beside(suffix)
            cause = self.cause + suffix
            self._kept[suffix] = Draws(self.scenes, self.seed, cause, self.loading, own)
        return self._kept[suffix]

    def _rows(
        self, what: str, size: Any, step: int, draw: Callable[[np.random.Generator], Any]
    ) -> NDArray[Any]:
        known = self._kept.get((what, size))
        if known is not None and known[0] == step:
            return known[1]
        streams = generators(f"fault/{self.cause}", self.scenes, self.seed, step)
        drawn = np.stack([draw(stream) for stream in streams])
        self._kept[what, size] = (step, drawn)
        return drawn


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
    """One behaviour, pure and batched over scenes.

    A reading is an array `[B, ...]` of NumPy, torch or any array-API namespace; the value has its
    shape, dtype and device. A step costs no host wait on an accelerator. Neither the reading nor
    the memory is written to. `apply` is called at every delivery until the fault is over, also
    before the onset, so that a delay has a past to draw on; the tap takes the value in the window.

    A subclass has a literal `kind` and is one of `faultpath.faults.kinds.Listed`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    value_field: ClassVar[str | None] = None
    """The field that takes VALUE in fault text `CHANNEL:KIND=VALUE`: the first after `kind`.
    `None`: there is none, and KIND stands alone."""
    random: ClassVar[bool] = False
    """Whether errors are drawn, so that those of several channels can be correlated."""
    phrase: ClassVar[str] = ""
    """Effect on the reading in a few words; a field's name in braces stands for its value."""

    @classmethod
    @override
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        cls.value_field = next((name for name in cls.model_fields if name != "kind"), None)

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the memory before the first `apply`, at the first delivery."""
        return None

    @abstractmethod
    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `(value, memory)`: what the reader would get, and what to carry on."""

    def is_random(self) -> bool:
        """Return whether errors are drawn, here or in a part."""
        return self.random

    def words(self) -> str:
        """Return what is done, in a few words."""
        return self.phrase.format_map({name: number(value) for name, value in self})

    def resolved(self, channel: Channel) -> Self:
        """Return the intervention with what it takes from the channel's declaration filled in."""
        return self

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Return why it cannot act on one scene's reading of `shape`, or `None`.

        By default, because the numbers of a field that holds several do not fit it.
        """
        kind: str = type(self).model_fields["kind"].default
        fields: list[tuple[str, Any]] = [
            (name, value) for name, value in self if isinstance(value, tuple)
        ]
        labels = {self.value_field: kind}  # as fault text has it: `offset=0.1/0`
        wrong = (misfit(labels.get(name, name), value, shape) for name, value in fields)
        return next(filter(None, wrong), None)


def number(value: Any) -> str:
    """Return a number or nested tuple of numbers in short form, and anything else as it is."""
    if isinstance(value, tuple):
        return "(" + ", ".join(map(number, cast("tuple[Any, ...]", value))) + ")"
    return f"{value:g}" if isinstance(value, float) else str(value)
