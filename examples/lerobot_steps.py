"""LeRobot's two steps for relative actions, rewritten for where LeRobot cannot be installed.

A copy of the interface of `RelativeActionsProcessorStep` and `AbsoluteActionsProcessorStep` of
LeRobot 0.6.1, in our words: the same names, fields, calls and results, without their registry and
their conversion of devices and types. `tests/foreign/test_lerobot.py` compares them with LeRobot's
own where that is installed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import torch

OBS_STATE = "observation.state"
Transition = dict[str, Any]


@dataclass
class RelativeActionsProcessorStep:
    """Keeps the state that it sees; takes it off absolute actions, as in training."""

    enabled: bool = False
    exclude_joints: list[str] = field(default_factory=list)
    action_names: Sequence[str] | None = None
    _last_state: torch.Tensor | None = field(default=None, init=False, repr=False)

    def __call__(self, transition: Transition) -> Transition:
        state = (transition.get("observation") or {}).get(OBS_STATE)
        if state is not None:
            self._last_state = state
        action = transition.get("action")
        if not self.enabled or action is None or state is None:
            return transition
        return transition | {"action": action - self._offset(action, state)}

    def get_cached_state(self) -> torch.Tensor | None:
        return self._last_state

    def _offset(self, action: torch.Tensor, state: torch.Tensor) -> torch.Tensor:
        """Return the state `[B, N]` where joints are relative, 0 elsewhere, as `action` has it."""
        excluded = [name.lower() for name in self.exclude_joints if name]
        names = [str(name).lower() for name in self.action_names or ()]
        keeps = [any(word in name for word in excluded) for name in names]
        offset = torch.zeros_like(action[..., 0, :] if action.ndim == 3 else action)
        for i in range(offset.shape[-1]):
            if i >= len(keeps) or not keeps[i]:
                offset[..., i] = state[..., i]
        return offset.unsqueeze(-2) if action.ndim == 3 else offset


@dataclass
class AbsoluteActionsProcessorStep:
    """Adds the state that its partner kept to relative actions."""

    enabled: bool = False
    relative_step: RelativeActionsProcessorStep | None = field(default=None, repr=False)

    def __call__(self, transition: Transition) -> Transition:
        action = transition.get("action")
        if not self.enabled or action is None:
            return transition
        state = self.relative_step.get_cached_state() if self.relative_step else None
        if state is None:
            raise RuntimeError("no state was kept: call the paired relative step before this one")
        return transition | {"action": action + self.relative_step._offset(action, state)}
