"""What one trial leaves behind."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray


class Status(StrEnum):
    """How a trial ended."""

    SUCCESS = "success"
    CRASH = "crash"
    TIMEOUT = "timeout"
    FAILED = "failed"
    """The program raised an error: the trial says nothing and voids every pair it is part of."""


@dataclass(frozen=True)
class Outcome:
    """The result of one closed-loop trial in one scene.

    The three hashes are of the initial state, the disturbance series and the planner's noise. Two
    trials may be compared as a pair only when all three agree.
    """

    scene: str
    status: Status
    time_s: float
    """Time at which the trial ended: the time to the goal for a success."""
    terminal_distance_m: float | None
    min_clearance_m: float | None
    initial_hash: str
    disturbance_hash: str
    planner_noise_hash: str
    struck_steps: int = 0
    """Control steps at which a fault was in force at some tap that delivered."""
    altered_steps: int = 0
    """Control steps at which what a consumer got differed from the reading."""
    error: str | None = None
    trace: NDArray[np.float32] | None = None
    """Position at each control step, `[T, 3]`, metres, world frame."""

    @property
    def failed(self) -> bool:
        """Whether the program failed, so that the trial says nothing."""
        return self.status is Status.FAILED
