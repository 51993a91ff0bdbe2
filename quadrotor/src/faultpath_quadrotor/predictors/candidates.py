"""What a planner asks about: candidates of the scenes that it plans for, chunk by chunk."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from torch import Tensor

from faultpath_quadrotor.lanes import Chunk
from faultpath_quadrotor.predictors.rollout import Rollout


@dataclass(frozen=True)
class Candidates:
    """A request to the predictor: where do these commands lead?"""

    count: int
    """Scenes of the batch, B."""
    parts: tuple[Chunk, ...]
    """The scenes that are planned for."""
    commands: tuple[Tensor, ...]
    """`[H, 4, S, K]` for each part, N and rad/s."""


@dataclass(frozen=True)
class Predicted:
    """The predictor's answer, and as such the request to the clearance."""

    count: int
    parts: tuple[Chunk, ...]
    rollouts: tuple[Rollout, ...]
    """One for each part."""

    def motion(self) -> Tensor:
        """Return positions and velocities of the whole batch, `[B, 6, H, K]`, m and m/s.

        Scenes that are not planned for have zeros.
        """
        first = self.rollouts[0].positions
        whole = first.new_zeros(6, self.count, *first.shape[2:])
        for part, rollout in zip(self.parts, self.rollouts, strict=True):
            whole[:3, part.rows] = rollout.positions
            whole[3:, part.rows] = rollout.velocities
        return whole.movedim(1, 0)

    def moved(self, motion: Tensor) -> "Predicted":
        """Return it with other positions and velocities `[B, 6, H, K]`; attitudes stay."""
        lanes = motion.movedim(0, 1)
        rollouts: Sequence[Rollout] = [
            _moved(rollout, lanes[:, part.rows].contiguous())
            for part, rollout in zip(self.parts, self.rollouts, strict=True)
        ]
        return replace(self, rollouts=tuple(rollouts))


def _moved(rollout: Rollout, motion: Tensor) -> Rollout:
    positions, velocities = motion[:3].contiguous(), motion[3:].contiguous()
    final = replace(rollout.final, position=positions[:, :, -1], velocity=velocities[:, :, -1])
    return Rollout(positions, velocities, final)
