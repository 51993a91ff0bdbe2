"""An error that is drawn anew at every step."""

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import model_validator

from faultpath.core.arrays import Array, Constant, is_zero
from faultpath.faults.base import Intervention, Memory, Moment, check_std, number, with_error


class Noise(Intervention):
    """Add Gaussian noise, drawn anew at every step and for every number of the reading."""

    kind: Literal["noise"] = "noise"
    value_field: ClassVar[str | None] = "std"
    random: ClassVar[bool] = True
    std: Constant
    """In the reading's unit, or as a fraction of the reading when `relative`."""
    relative: bool = False

    @model_validator(mode="after")
    def _not_negative(self) -> Self:
        check_std(self.std)
        return self

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading + std * n`, or `reading * (1 + std * n)` when relative."""
        if at.before or is_zero(self.std):
            return reading, None
        error = np.asarray(self.std) * at.draws.normal(tuple(reading.shape[1:]), at.step)
        return with_error(reading, error, self.relative), None

    def words(self) -> str:
        """Return `noise of std STD`."""
        return f"{'relative ' if self.relative else ''}noise of std {number(self.std)}"
