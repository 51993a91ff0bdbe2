"""A variant with its models on recorded windows, under faults."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import torch
from faultpath_quadrotor.predictors import Predictor
from faultpath_quadrotor.reconstruction import Reconstruction
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training.windows import HISTORY, Windows
from torch import Tensor

from faultpath.core.errors import UserError
from faultpath.core.streams import generators
from faultpath.faults import Delay, Drift, Dropout, Fault, Freeze, Hold, resolve
from faultpath.loop import Reading, Taps
from faultpath.system import Variant
from faultpath_paper.evidence.playback import CODE, HELD, Present, at_present

_BY_WINDOW = HELD | {"wind"}
_BY_RECORDING = frozenset({CODE[0]})
_IN_TIME = (Delay, Drift, Dropout, Freeze, Hold)


_STEPS = ("position", "velocity", "rotation", "rate", "command", "wind_mps", "motor_thrust_n")
"""Fields of windows that have a value for every step, `[..., T, W]`."""


def with_shuffled_history(windows: Windows, seed: int) -> Windows:
    """Return windows whose 12 steps of history, states with their commands, have changed places.

    The order is drawn for each window by itself; its present and what lies ahead stay.
    """
    streams = generators("history steps", windows.ids, seed)
    orders = torch.from_numpy(np.stack([stream.permutation(HISTORY) for stream in streams], 1))

    def shuffled(values: Tensor) -> Tensor:
        past, rest = values[..., :HISTORY, :], values[..., HISTORY:, :]
        return torch.cat((past.gather(-2, orders.expand(past.shape)), rest), -2)

    return replace(windows, **{name: shuffled(getattr(windows, name)) for name in _STEPS})


@dataclass(frozen=True)
class Subject:
    """A variant with its models, to be measured on recorded windows."""

    system: Quadrotor
    variant: Variant
    seed: int
    predictor: Predictor
    reconstruction: Reconstruction | None

    @classmethod
    def load(cls, system: Quadrotor, name: str, seed: int) -> Subject:
        """Load a variant; `UserError` where a checkpoint is missing."""
        parts = system.variant_parts[name]
        models = parts.load_predictor(seed), parts.load_reconstruction(seed)
        return cls(system, system.variants[name], seed, *models)

    def at_present(self, windows: Windows, faults: Sequence[str], recording: str) -> Present:
        """Return what the variant gets and predicts at the present of a recording's windows.

        `UserError` for a fault that does not fit the variant, or that windows cannot have.
        """
        by_window, by_recording = self._parse(faults)
        return at_present(
            windows,
            self.predictor,
            self.reconstruction,
            self.variant.bindings,
            by_window,
            self.seed,
            partial(self._exchanged, recording, by_recording),
        )

    def _parse(
        self, texts: Sequence[str]
    ) -> tuple[list[tuple[Fault, ...]], list[tuple[Fault, ...]]]:
        system = self.system
        by_window: list[tuple[Fault, ...]] = []
        by_recording: list[tuple[Fault, ...]] = []
        for text in texts:
            parts = system.fault(text)
            channels = {part.channel for part in parts}
            if any(
                isinstance(part.intervention, _IN_TIME)
                or part.onset_step != 0
                or part.duration_steps is not None
                for part in parts
            ):
                raise UserError(
                    f"fault '{text}' acts in time, and a recorded window has one present: leave "
                    "times out, or fly it with `faultpath audit`"
                )
            if channels <= _BY_WINDOW:
                by_window.append(parts)
            elif channels <= _BY_RECORDING:
                by_recording.append(parts)
            else:
                known = ", ".join(sorted(_BY_WINDOW | _BY_RECORDING))
                raise UserError(
                    f"fault '{text}' is of a channel that recorded windows do not deliver: "
                    f"they deliver {known}"
                )
        return by_window, by_recording

    def _exchanged(
        self, recording: str, faults: Sequence[tuple[Fault, ...]], codes: Tensor
    ) -> Tensor:
        """Return history codes `[W, 32]` as delivered.

        For this tap the whole recording is one scene. A shuffle permutes a scene's own reading,
        and so exchanges the codes of windows: each is one that the predictor meets in flight, but
        of another history.
        """
        source = self.system.interface.channel(CODE[0]).sources[0]
        interface = self.system.interface.shaped({source: tuple(codes.shape)})
        taps = Taps(
            interface,
            [f for parts in faults for f in resolve(parts, interface, self.variant.readers)],
            scenes=(recording,),
            dt_s=self.system.control_dt_s,
            seed=self.seed,
            bindings=self.variant.bindings,
            readers=self.variant.readers,
            privileged=self.variant.privileged,
        )
        reading = Reading(codes[None], taps.bindings[CODE[0]], 0)
        delivered = taps.deliver(*CODE, reading, 0)
        taps.verify(last_step=0)
        return delivered[0]
