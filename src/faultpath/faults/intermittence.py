"""Faults that come and go: on and off for random times."""

from dataclasses import dataclass
from math import exp

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from faultpath.faults.draws import Draws


class Intermittence(BaseModel):
    """On and off in turn, for exponentially distributed times (a two-state Markov chain).

    Every scene begins on at the onset. In the long run a fault acts for the share
    `mean_on_s / (mean_on_s + mean_off_s)` of the time.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    mean_on_s: float = Field(gt=0)
    mean_off_s: float = Field(gt=0)

    def words(self) -> str:
        """Return `on for ON s and off for OFF s on average`."""
        return f"on for {self.mean_on_s:g} s and off for {self.mean_off_s:g} s on average"


@dataclass
class Phases:
    """The phase of every scene, moved on step by step on the host."""

    what: Intermittence
    onset: NDArray[np.int64]
    """First step in force, `[B]`."""
    dt_s: float
    draws: Draws
    begun: NDArray[np.int64]
    """First step of the phase that is under way, `[B]`."""
    on: NDArray[np.bool_]
    step: int = -1

    @classmethod
    def of(
        cls, what: Intermittence, onset: NDArray[np.int64], dt_s: float, draws: Draws
    ) -> "Phases":
        """Return the phases before the first step."""
        return cls(what, onset, dt_s, draws, onset.copy(), np.zeros(onset.shape, dtype=bool))

    def elapsed(self, step: int) -> NDArray[np.int64]:
        """Return the steps since the phase on began, `[B]`: negative where the fault is off."""
        for now in range(self.step + 1, step + 1):
            self._move(now)
        self.step = max(self.step, step)
        return np.where(self.on, step - self.begun, -1)

    def _move(self, step: int) -> None:
        drawn = self.draws.uniform((), step)
        ends: NDArray[np.bool_] = np.where(
            self.on,
            drawn < 1 - exp(-self.dt_s / self.what.mean_on_s),
            drawn < 1 - exp(-self.dt_s / self.what.mean_off_s),
        )
        on = np.where(step > self.onset, self.on ^ ends, step == self.onset)
        self.begun = np.where(on & ~self.on, step, self.begun)
        self.on = on
