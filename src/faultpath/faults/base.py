"""What is done to a reading: the shape that every intervention has."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self, TypeAlias, cast

import numpy as np
from pydantic import BaseModel, ConfigDict

from faultpath.core.arrays import Array, Constant, HostArray, like, misfit
from faultpath.faults.draws import Draws
from faultpath.interface import Channel

Memory: TypeAlias = Any
"""What an intervention carries from step to step: an array, a tuple or `None`; never written to."""


@dataclass(frozen=True, slots=True)
class Moment:
    """When an intervention is asked for its value."""

    step: int
    """Control step, from 0."""
    elapsed: int
    """Steps since the onset, negative before it."""
    dt_s: float
    """Length of a control step, s."""
    draws: Draws

    def part(self, index: int) -> "Moment":
        """Return the same moment with the independent draws of one part."""
        return replace(self, draws=self.draws.part(index))


class Intervention(BaseModel, ABC):
    """One behaviour, pure and batched over scenes.

    A reading is an array `[B, ...]` of NumPy, torch or any array-API namespace; the value has its
    shape, dtype and device. A step costs no host wait on an accelerator. Neither the reading nor
    the memory is written to. `apply` is called at every delivery from the first on, also before
    the onset, so that a delay has a past to draw on; the tap takes the value within the window.

    A subclass has a literal `kind`, states its fields, and is named once in `registry.py`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    value_field: ClassVar[str | None] = None
    """The field that takes VALUE in fault text `CHANNEL:KIND=VALUE`; `None`: KIND stands alone."""
    random: ClassVar[bool] = False
    """Whether errors are drawn, so that those of several channels can be correlated."""

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the memory before the first `apply`, at the first delivery."""
        return None

    @abstractmethod
    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `(value, memory)`: what the consumer would get, and what to carry on."""

    def is_random(self) -> bool:
        """Return whether errors are drawn, here or in a part."""
        return self.random

    said: ClassVar[str] = ""
    """What is done, in a few words; a field's name in braces stands for its value."""

    def words(self) -> str:
        """Return what is done, in a few words."""
        return self.said.format_map({name: number(value) for name, value in self})

    def resolved(self, channel: Channel) -> Self:
        """Return the intervention with what it takes from the channel's declaration filled in."""
        return self

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Return why it cannot act on one scene's reading of `shape`, or `None`.

        By default, because the numbers of a field that holds several do not fit it.
        """
        laid: list[tuple[str, Any]] = [each for each in self if isinstance(each[1], tuple)]
        return next(filter(None, (misfit(name, value, shape) for name, value in laid)), None)


def number(value: Any) -> str:
    """Return a number or nested tuple of numbers in short form, and anything else as it is."""
    if isinstance(value, tuple):
        return "(" + ", ".join(map(number, cast("tuple[Any, ...]", value))) + ")"
    return f"{value:g}" if isinstance(value, float) else str(value)


def with_error(reading: Array, error: HostArray, relative: bool) -> Array:
    """Return the reading plus `error`, or times `1 + error` when relative."""
    return reading * like(1 + error, reading) if relative else reading + like(error, reading)


def check_std(std: Constant) -> None:
    """Raise `ValueError` for a negative standard deviation."""
    if np.any(np.asarray(std) < 0):
        raise ValueError("std must not be negative")
