"""Recorded windows under the loop of a flight: a plant that plays them back up to their present.

The modules are those that fly, stepped by `faultpath.loop` from the first instant of a window, with
what was executed in the planner's place.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import torch
from faultpath_quadrotor.batching import Chunk
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.interface import quadrotor_interface
from faultpath_quadrotor.plant.module import ACTION
from faultpath_quadrotor.predictors import Predictor
from faultpath_quadrotor.predictors.rollout import Candidates, Predicted
from faultpath_quadrotor.reconstruction import Reconstruction
from faultpath_quadrotor.state import padded_lanes
from faultpath_quadrotor.training.windows import HISTORY, HORIZON, Windows
from faultpath_quadrotor.variants import modelled
from faultpath_quadrotor.vehicle import CONTROL_DT_S
from torch import Tensor
from typing_extensions import override

from faultpath.faults import Fault, resolve
from faultpath.loop import (
    Batch,
    Inputs,
    Loop,
    Memory,
    Module,
    Outputs,
    Plant,
    Port,
    Progress,
    Reading,
    Taps,
    graph,
    readers,
)

CODE = ("history_code", "predictor.latent")
HELD = frozenset({"mass", "thrust_scale"})
"""Channels that taps act on once a window, for its history and its present."""
PRIVILEGED = ("true_wind", "true_physics")

Exchange = Callable[[Tensor], Tensor]


class Playback(Plant):
    """Plays windows back from their first instant to their present."""

    name = "vehicle"
    reads = frozenset({ACTION})
    shows = ("vehicle",)
    senses = ("true_physics", "true_wind", "zero_wind")
    steps = HISTORY + 1

    def __init__(self, windows: Windows) -> None:
        self._windows = windows

    def start(self, batch: Batch) -> int:
        """Return the first instant."""
        del batch
        return 0

    def sense(self, state: int) -> Outputs:
        """Return the recorded readings of an instant."""
        windows, vehicle = self._windows, self._windows.state(state)
        truth = {
            "position": vehicle.position,
            "velocity": vehicle.velocity,
            "attitude": vehicle.rotation,
            "body_rate": vehicle.rate,
            **windows.calibration,
        }
        wind = windows.wind_mps[:, state].T
        return {
            "true_physics": windows.physics(state).reading().T,
            "true_wind": wind,
            "zero_wind": torch.zeros_like(wind),
            "vehicle": {name: value.movedim(-1, 0) for name, value in truth.items()},
        }

    def advance(self, state: int, inputs: Inputs) -> int:
        """Return the next instant, whatever is commanded."""
        del inputs
        return state + 1

    def progress(self, state: int) -> Progress:
        """Return that every window runs to its present."""
        none = torch.zeros(len(self._windows), dtype=torch.bool)
        return Progress(~none, none, none, torch.full(none.shape, state * CONTROL_DT_S))

    def conditions(self, state: int) -> tuple[Sequence[str], Sequence[str]]:
        """Return the ids of the windows: nothing else tells them apart."""
        return self._windows.ids, self._windows.ids


class Executed(Module):
    """Stands in for the planner: commands what was executed."""

    name, writes = "planner", ("commanded_action",)
    reads = frozenset({Port("rollout", "candidates")})

    def __init__(self, windows: Windows) -> None:
        self._windows = windows

    @override
    def before(self, batch: Batch) -> Outputs:
        return {"commanded_action": torch.zeros(len(batch.scenes), 4)}

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return the command of the step, `[W, 4]`; nobody plans."""
        return {"commanded_action": self._windows.command[:, inputs.step].T}, memory


class WindowTaps:
    """Stands before taps to which a window is a trial of one step, its present.

    Faults draw once per window. A changed calibration holds over the history; everything else
    changes at the present alone.
    """

    def __init__(self, taps: Taps, exchange: Exchange) -> None:
        self.delivered: dict[tuple[str, str], Any] = {}
        """Values delivered at the present, by channel and reader."""
        self.set_active = taps.set_active
        self._taps, self._exchange = taps, exchange

    def deliver(
        self, channel: str, reader: str, reading: Reading, step: int, scene: int | None = None
    ) -> Any:
        """Return what a reader gets; over the history, most channels as they were recorded."""
        if step < HISTORY and channel not in HELD:
            return reading.value
        value = self._exchange(reading.value) if channel == CODE[0] else reading.value
        delivered = self._taps.deliver(channel, reader, Reading(value, reading.source, 0), 0, scene)
        self.delivered[channel, reader] = delivered
        return delivered


@dataclass(frozen=True)
class Present:
    """Values that modules got at the present of windows, and the predictions from them."""

    windows: Windows
    """The windows, padded with the first one to a multiple of 32."""
    count: int
    """Number of windows without the padding."""
    delivered: Mapping[tuple[str, str], Any]

    def __getitem__(self, tap: tuple[str, str]) -> Tensor:
        """Return what a reader got of a channel, `[W, ...]`."""
        return self.delivered[tap][: self.count]

    def wind(self) -> Tensor:
        """Return the wind that the predictor got, `[3, W]`, m/s."""
        return self["wind", "predictor.wind_map"].T

    def positions(self) -> Tensor:
        """Return the predicted positions 13 to 32 under what was executed, `[3, W, 20]`, m."""
        lanes = len(self.windows)
        commands = self.windows.command[:, HISTORY:].movedim(1, 0)[..., None]
        part = Chunk(tuple(range(lanes)), torch.arange(lanes))
        candidates = Candidates(lanes, (part,), (commands,))
        predicted: Predicted = self.delivered["rollout", "planner.candidates"](candidates)
        return predicted.rollouts[0].positions[:, : self.count, :, 0]


def at_present(
    windows: Windows,
    predictor: Predictor,
    reconstruction: Reconstruction | None,
    bindings: Mapping[str, str],
    faults: Iterable[tuple[Fault, ...]] = (),
    seed: int = 0,
    exchange: Exchange = lambda codes: codes,
) -> Present:
    """Step a variant's modules through the history of windows, up to the present.

    No window's bits depend on how many there are.

    Args:
        windows: Some windows, W.
        predictor: Model whose rollouts `Present.positions` reads.
        reconstruction: Estimator of the wind, if there is one.
        bindings: Channel to source, where it is not the channel's first.
        faults: Faults that act on windows one by one; those of a tuple act together.
        seed: Seed of the faults' random numbers.
        exchange: Change to the history codes of the whole recording, `[W, 32]`.

    Raises:
        UserError: A fault does not fit, or acts on nobody here.
    """
    lanes = padded_lanes(len(windows))
    wide = windows.take(lanes)
    interface = quadrotor_interface().shaped({"predicted_motion": (6, HORIZON, 1)})
    models = modelled(predictor, reconstruction, CPU)
    parts = graph(interface, Playback(wide), [*models, Executed(wide)], bindings)
    present = readers(parts.parts)
    taps = Taps(
        interface,
        [fault for parts in faults for fault in resolve(parts, interface, present)],
        scenes=wide.ids,
        dt_s=CONTROL_DT_S,
        seed=seed,
        bindings=bindings,
        readers=present,
        privileged=PRIVILEGED,
    )
    window_taps = WindowTaps(taps, lambda codes: exchange(codes[: len(windows)])[lanes])
    for _ in Loop(interface, parts).execute(Batch(wide.ids, seed, CONTROL_DT_S), window_taps):
        pass
    taps.verify(last_step=0)
    return Present(wide, len(windows), window_taps.delivered)
