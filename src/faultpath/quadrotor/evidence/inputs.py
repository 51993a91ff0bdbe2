"""What a variant's modules are told on every window: through taps, and under faults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath.errors import UserError
from faultpath.faults import AnyFault, Coupled, Delay, Drift, Dropout, Freeze, Hold, parse_fault
from faultpath.quadrotor.predictors import Predictor
from faultpath.quadrotor.reconstruction import Reconstruction
from faultpath.quadrotor.state import padded_lanes
from faultpath.quadrotor.system import Quadrotor
from faultpath.quadrotor.training.quality_predictors import BATCH
from faultpath.quadrotor.training.quality_reconstructions import estimate
from faultpath.quadrotor.training.replay import Supplied, history
from faultpath.quadrotor.training.windows import HISTORY, Windows
from faultpath.quadrotor.variants import choices
from faultpath.taps import Reading, Taps
from faultpath.trials import Variant

_CALIBRATION = ("mass", "thrust_scale")
_BY_WINDOW = frozenset({*_CALIBRATION, "wind"})
_BY_RECORDING = frozenset({"history_code"})
_IN_TIME = (Delay, Drift, Dropout, Freeze, Hold)


@dataclass(frozen=True)
class Told:
    """What the taps of a variant deliver on W windows."""

    supplied: Supplied
    """Calibration by channel and consumer, `[W]` each."""
    wind_mps: Tensor | None
    """`[3, W]`; `None` for a predictor without a wind input."""
    code: Tensor | None
    """History code `[32, W]`; `None` for a predictor without a memory."""


@dataclass(frozen=True)
class Subject:
    """A variant with its models: what is measured."""

    system: Quadrotor
    variant: Variant
    seed: int
    predictor: Predictor
    reconstruction: Reconstruction | None

    @classmethod
    def load(cls, system: Quadrotor, name: str, seed: int) -> Subject:
        """Load a variant; `UserError` for an unknown one, or where a checkpoint is missing."""
        found = {choice.name: choice for choice in choices(system.options)}
        if name not in found:
            raise UserError(
                f"the quadrotor has no variant {name!r} to measure: choose from {', '.join(found)}"
            )
        return cls(
            system,
            system.variants[name],
            seed,
            found[name].load_predictor(seed),
            found[name].load_reconstruction(seed),
        )

    def check(self, faults: Sequence[str]) -> None:
        """Raise the `UserError` that `tell` would raise about these faults on any windows."""
        for found in self._parse(faults):
            self._taps(("any",), found)

    def tell(self, windows: Windows, faults: Sequence[str], recording: str) -> Told:
        """Return what the modules get on windows of the recording of that name.

        `UserError` for a fault that does not fit the variant, or of a channel or in a way that
        windows do not have.
        """
        by_window, by_recording = self._parse(faults)
        taps = self._taps(windows.ids, by_window)
        lanes = padded_lanes(len(windows))
        wide = windows.take(lanes)
        supplied = self._supplied(taps, windows)
        spread = {tap: value[lanes] for tap, value in supplied.items()}
        wind = self._wind(taps, wide, spread, len(windows))
        taps.verify(last_step=0)
        return Told(supplied, wind, self._code(recording, by_recording, wide, spread, len(windows)))

    def _parse(self, texts: Sequence[str]) -> tuple[list[AnyFault], list[AnyFault]]:
        """Return the faults that strike windows one by one, and those that strike all at once."""
        system = self.system
        by_window: list[AnyFault] = []
        by_recording: list[AnyFault] = []
        for text in texts:
            fault = parse_fault(text, system.interface, system.fault_presets, system.control_dt_s)
            parts = fault.faults if isinstance(fault, Coupled) else (fault,)
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
                by_window.append(fault)
            elif channels <= _BY_RECORDING:
                by_recording.append(fault)
            else:
                known = ", ".join(sorted(_BY_WINDOW | _BY_RECORDING))
                raise UserError(
                    f"fault '{text}' is of a channel that recorded windows do not deliver: "
                    f"they deliver {known}"
                )
        return by_window, by_recording

    def _taps(
        self,
        rows: tuple[str, ...],
        faults: Sequence[AnyFault],
        shapes: Mapping[str, tuple[int, ...]] | None = None,
    ) -> Taps:
        return Taps(
            self.system.interface.shaped(shapes or {}),
            faults,
            scenes=rows,
            dt_s=self.system.control_dt_s,
            seed=self.seed,
            bindings=self.variant.bindings,
            consumers=self.variant.consumers,
            privileged=self.variant.privileged,
        )

    def _supplied(self, taps: Taps, windows: Windows) -> Supplied:
        values = dict(zip(_CALIBRATION, (windows.mass_kg, windows.thrust_scale), strict=True))
        return {
            (name, consumer): taps.deliver(
                name, consumer, Reading(values[name], taps.bindings[name], 0), 0
            )
            for name in _CALIBRATION
            for consumer in self.system.interface.channel(name).consumers
            if consumer in self.variant.consumers
        }

    def _wind(self, taps: Taps, wide: Windows, told: Supplied, count: int) -> Tensor | None:
        if "wind_map" not in self.predictor.reads:
            return None
        source = taps.bindings["wind"]
        if self.reconstruction is not None:
            value = estimate(self.reconstruction, wide, told)
        else:
            truth = wide.wind_mps[:, HISTORY]
            value = truth if source == "true_wind" else torch.zeros_like(truth)
        reading = Reading(value[:, :count].T, source, 0)
        return taps.deliver("wind", "predictor.wind_map", reading, 0).T

    def _code(
        self,
        recording: str,
        faults: Sequence[AnyFault],
        wide: Windows,
        told: Supplied,
        count: int,
    ) -> Tensor | None:
        """Return the history code as delivered.

        For this tap the whole recording is one scene and its reading is `[W, 32]`. A shuffle
        permutes a scene's own reading, and so exchanges the codes of windows: each is one that the
        predictor meets in flight, but of another history.
        """
        if "history" not in self.predictor.reads:
            return None
        codes = [
            self.predictor.encode(
                history(
                    self.predictor,
                    wide.take(index),
                    {tap: value[index] for tap, value in told.items()},
                )
            )
            for index in torch.arange(len(wide)).split(BATCH)
        ]
        code = torch.cat([each for each in codes if each is not None], 1)[:, :count]
        (source,) = self.system.interface.channel("history_code").sources
        taps = self._taps((recording,), faults, {source: tuple(code.T.shape)})
        reading = Reading(code.T[None], source, 0)
        delivered = taps.deliver("history_code", "predictor.latent", reading, 0)
        taps.verify(last_step=0)
        return delivered[0].T
