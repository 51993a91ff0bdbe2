"""Faults of cameras: on readings whose last two axes are rows and columns.

Axes before these, such as channels or time, share what is drawn for a scene.
"""

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from faultpath.arrays import Array, HostArray, copy, kept, namespace, place
from faultpath.faults.base import Intervention, Memory, Moment


def _laid(mask: HostArray, reading: Array) -> Array:
    ones = (1,) * (reading.ndim - 3)
    return place(mask.reshape(mask.shape[0], *ones, *mask.shape[1:]), reading)


class _Image(Intervention):
    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Refuse a reading without rows and columns."""
        if len(shape) >= 2:
            return None
        return f"it needs rows and columns, and the reading of one scene has shape {list(shape)}"


class Occlusion(_Image):
    """Cover a rectangle of the image's own proportions, placed once a scene."""

    kind: Literal["occlusion"] = "occlusion"
    said = "covered over {share} of the image"
    value_field: ClassVar[str | None] = "share"
    random: ClassVar[bool] = True
    share: float = Field(ge=0, le=1)
    """Covered share of the image."""
    shows: float = 0.0
    """What is seen there, in the reading's unit."""

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the covered pixels, `[B, H, W]`."""
        height, width = (int(size) for size in reading.shape[-2:])
        rows, columns = (round(size * self.share**0.5) for size in (height, width))
        corner = at.draws.uniform((2,), 0)
        top = np.floor(corner[:, :1] * (height - rows + 1))
        left = np.floor(corner[:, 1:] * (width - columns + 1))
        down: HostArray = np.arange(height)[None]
        across: HostArray = np.arange(width)[None]
        in_rows: HostArray = (down >= top) & (down < top + rows)
        in_columns: HostArray = (across >= left) & (across < left + columns)
        return _laid(in_rows[:, :, None] & in_columns[:, None, :], reading)

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the reading with `shows` in the covered rectangle."""
        xp = namespace(reading)
        return xp.where(memory, xp.full_like(reading, self.shows), reading), memory


class SaltAndPepper(_Image):
    """Set each pixel with a probability to the least or the greatest value, drawn at every step."""

    kind: Literal["salt_and_pepper"] = "salt_and_pepper"
    said = "salt and pepper on {probability} of the pixels"
    value_field: ClassVar[str | None] = "probability"
    random: ClassVar[bool] = True
    probability: float = Field(ge=0, le=1)
    low: float = 0.0
    high: float = 1.0
    """In the reading's unit."""

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the reading with half of the struck pixels low and half high."""
        if at.before or not self.probability:
            return reading, None
        xp = namespace(reading)
        drawn = _laid(at.draws.uniform(tuple(reading.shape[-2:]), at.step), reading)
        value = xp.where(drawn < self.probability, xp.full_like(reading, self.high), reading)
        low = xp.full_like(reading, self.low)
        return xp.where(drawn < self.probability / 2, low, value), None


class Blur(_Image):
    """Average each pixel with its neighbours up to `radius` away; edges repeat outwards."""

    kind: Literal["blur"] = "blur"
    said = "blurred over {radius} pixels"
    value_field: ClassVar[str | None] = "radius"
    radius: int = Field(ge=0)

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the mean over a square of `2 * radius + 1` pixels a side."""
        value = reading if not self.radius else self._along(self._along(reading, -1), -2)
        return value, None

    def _along(self, image: Array, axis: int) -> Array:
        xp = namespace(image)
        size = int(image.shape[axis])
        total = xp.zeros_like(image)
        for shift in range(-self.radius, self.radius + 1):
            from_: HostArray = np.clip(np.arange(size) + shift, 0, size - 1)
            total = total + xp.take(image, place(from_, image), axis=image.ndim + axis)
        return total / (2 * self.radius + 1)


class Exposure(_Image):
    """Multiply by a factor and clip to what the camera can show."""

    kind: Literal["exposure"] = "exposure"
    said = "exposed {factor} times, clipped to {low} … {high}"
    value_field: ClassVar[str | None] = "factor"
    factor: float = Field(ge=0)
    low: float = 0.0
    high: float = 1.0
    """In the reading's unit."""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.low >= self.high:
            raise ValueError("low must be below high")
        return self

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `clip(reading * factor, low, high)`."""
        return namespace(reading).clip(reading * self.factor, self.low, self.high), None


class StuckRows(_Image):
    """Hold some rows, drawn once a scene, at what they showed at the onset."""

    kind: Literal["stuck_rows"] = "stuck_rows"
    said = "with {share} of its rows stuck"
    value_field: ClassVar[str | None] = "share"
    share: float = Field(ge=0, le=1)
    """Share of the rows."""

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the rows `[B, H, 1]` and what they show."""
        height = reading.shape[-2]
        rank = at.draws.permutation(height, 0)
        return _laid((rank < round(self.share * height))[:, :, None], reading), copy(reading)

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the reading with the stuck rows of the onset."""
        rows, held = memory
        held = kept(at.elapsed <= 0, reading, held)
        return namespace(reading).where(rows, held, reading), (rows, held)
