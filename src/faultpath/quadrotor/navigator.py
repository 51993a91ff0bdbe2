"""The modules under test, wired through taps: one control step from readings to command."""

import hashlib
from collections.abc import Sequence
from functools import lru_cache, partial

import torch
from torch import Tensor

from faultpath.quadrotor import so3
from faultpath.quadrotor.chunks import Chunk, chunks
from faultpath.quadrotor.clearance import ClearanceSource
from faultpath.quadrotor.device import at_hand, send
from faultpath.quadrotor.history import HistoryRecord
from faultpath.quadrotor.planner import MPPI, Proposal, shift
from faultpath.quadrotor.predictors import Calibration, Physics, PredictorInputs
from faultpath.quadrotor.reconstruction import Reconstruction
from faultpath.quadrotor.sensors import (
    STATE_CHANNELS,
    Sensors,
    initial_state,
    lanes_last,
    scenes_first,
)
from faultpath.quadrotor.state import State
from faultpath.quadrotor.vehicle import GRAVITY_MPS2
from faultpath.taps import ModuleTaps, Reading, Taps


class WindReconstruction:
    """The reconstruction module behind its taps."""

    def __init__(self, reconstruction: Reconstruction, taps: ModuleTaps, lanes: Tensor) -> None:
        self._reconstruction = reconstruction
        self._taps = taps
        self._lanes = lanes
        self._memory = None

    def observe(self, sensors: Sensors, executed: Reading, step: int) -> Reading:
        """Take the step's readings in and return the reconstructed wind."""
        delivered = {
            (channel, place): self._take(sensors, executed, channel, place, step)
            for channel, place in sorted(self._reconstruction.reads)
        }
        if self._memory is None:
            self._memory = self._reconstruction.begin(delivered)
        else:
            self._memory = self._reconstruction.update(self._memory, delivered)
        wind = self._reconstruction.wind(self._memory)
        count = executed.value.shape[0]
        return Reading(wind[..., :count].movedim(-1, 0), "reconstructed_wind", step)

    def _take(
        self, sensors: Sensors, executed: Reading, channel: str, place: str, step: int
    ) -> Tensor:
        reading = executed if channel == "action" else sensors.readings[channel]
        return lanes_last(self._taps.deliver(channel, place, reading, step), self._lanes)


class Navigator:
    """Reads the sensors through taps, plans, and returns the command for the actuators."""

    def __init__(
        self,
        planner: MPPI,
        reconstruction: WindReconstruction | None,
        clearance: ClearanceSource,
        taps: Taps,
        scenes: Sequence[str],
        seed: int,
        lanes: Tensor,
    ) -> None:
        self._planner = planner
        self._reconstruction = reconstruction
        self._clearance = clearance
        self._predictor_taps = taps.for_module("predictor")
        self._planner_taps = taps.for_module("planner")
        self._vehicle_taps = taps.for_module("vehicle")
        self._scenes = tuple(scenes)
        self._seed = seed
        self._lanes = lanes
        self._chunks = lru_cache(maxsize=2)(partial(chunks, device=lanes.device))
        self._wind_source = taps.bindings["wind"]
        self._reads = planner.predictor.reads
        self._history = (
            HistoryRecord(self._predictor_taps, lanes) if "history" in self._reads else None
        )
        self._plan: Tensor | None = None
        self._executed: Reading | None = None

    def act(self, sensors: Sensors, step: int, running: Sequence[int]) -> Tensor:
        """Return the command `[4, L]` that reaches the actuators; only `running` scenes plan."""
        inputs = self._inputs(sensors, step)
        hover = inputs.trim.hover_thrust(GRAVITY_MPS2)[:, 0]
        if self._plan is None:
            self._plan = self._planner.initial_plan(hover)
        goal = self._planner_taps.deliver("goal", "goal_cost", sensors.readings["goal"], step)
        goal = lanes_last(goal, self._lanes).float()
        self._clearance.look(sensors, step)

        parts = self._chunks(tuple(running))
        proposals = [self._propose(inputs, part, step) for part in parts]
        clearance = self._query(parts, proposals, step)
        command = self._planner.initial_plan(hover)[0]
        for part, proposal in zip(parts, proposals, strict=True):
            rows = part.rows
            plan = self._planner.decide(proposal, clearance[rows], goal[:, rows])
            command[:, rows] = plan[0]
            self._plan[..., rows] = shift(plan)
        return self._actuate(command, step)

    def noise_hashes(self) -> tuple[str, ...]:
        """Return, for each scene, a hash of the noise that its first replan drew."""
        return tuple(
            hashlib.sha256(
                self._planner.sampler.noise([scene], self._seed, 0).numpy().tobytes()
            ).hexdigest()[:16]
            for scene in self._scenes
        )

    def _inputs(self, sensors: Sensors, step: int) -> PredictorInputs:
        """Take from the taps what the predictor reads, and nothing else."""

        def take(channel: str, place: str) -> Tensor:
            return self._predictor_taps.deliver(channel, place, sensors.readings[channel], step)

        def lane(channel: str, place: str) -> Tensor:
            return lanes_last(take(channel, place), self._lanes).float()[..., None]

        def calibration(place: str) -> Calibration:
            return Calibration(lane("mass", place), lane("thrust_scale", place))

        reads = self._reads
        executed = self._last_command(sensors, step)
        state = initial_state(
            {name: take(name, "initial_state") for name in STATE_CHANNELS}, self._lanes
        )
        trim = calibration("trim")
        conditioning = calibration("features") if "features" in reads else None
        return PredictorInputs(
            state=_float_column(state),
            trim=trim,
            dynamics=calibration("dynamics") if "dynamics" in reads else None,
            wind_map_mass_kg=lane("mass", "wind_map") if "wind_map" in reads else None,
            wind_mps=self._wind(sensors, executed, step) if "wind_map" in reads else None,
            physics=_physics(lane("physics", "physics")) if "physics" in reads else None,
            thrust_mass_kg=(
                lane("mass", "normalise_thrust") if "normalise_thrust" in reads else None
            ),
            conditioning=conditioning,
            code=self._code(sensors, executed, trim, conditioning, step),
        )

    def _last_command(self, sensors: Sensors, step: int) -> Reading:
        if self._executed is None:  # nothing has been commanded yet: the motors hover
            blank = sensors.readings["mass"].value
            self._executed = Reading(blank.new_zeros(len(blank), 4), "commanded_action", step)
        return self._executed

    def _wind(self, sensors: Sensors, executed: Reading, step: int) -> Tensor:
        if self._reconstruction is not None:
            reading = self._reconstruction.observe(sensors, executed, step)
        else:
            reading = {"true_wind": sensors.true_wind, "zero_wind": sensors.zero_wind}[
                self._wind_source
            ]
        wind = self._predictor_taps.deliver("wind", "wind_map", reading, step)
        return lanes_last(wind, self._lanes).float()[..., None]

    def _code(
        self,
        sensors: Sensors,
        executed: Reading,
        trim: Calibration,
        conditioning: Calibration | None,
        step: int,
    ) -> Tensor | None:
        if self._history is None:
            return None
        history = self._history.observe(sensors, executed, trim, conditioning, step)
        code = self._planner.predictor.encode(history)
        assert code is not None
        reading = Reading(scenes_first(code, len(self._scenes)), "history_encoding", step)
        delivered = self._predictor_taps.deliver("history_code", "latent", reading, step)
        return lanes_last(delivered, self._lanes)[..., None]

    def _propose(self, inputs: PredictorInputs, chunk: Chunk, step: int) -> Proposal:
        assert self._plan is not None
        scenes, rows = [self._scenes[i] for i in chunk.scenes], chunk.index
        noise = send(self._planner.sampler.noise(scenes, self._seed, step), rows.device)
        return self._planner.propose(inputs.take(rows), self._plan[..., rows], noise)

    def _query(self, parts: Sequence[Chunk], proposals: list[Proposal], step: int) -> Tensor:
        """Query the clearance along all rollouts and deliver it for the whole block at once."""
        first = proposals[0].rollout.positions
        clearance = first.new_zeros(len(self._scenes), *first.shape[2:])
        for part, proposal in zip(parts, proposals, strict=True):
            points = proposal.rollout.positions
            values = self._clearance.query(points.flatten(2), part)
            clearance[part.rows] = values.view(points.shape[1:])
        reading = Reading(clearance, self._clearance.name, step)
        return self._planner_taps.deliver("clearance", "risk_cost", reading, step)

    def _actuate(self, command: Tensor, step: int) -> Tensor:
        scenes = command[:, : len(self._scenes)].T.double()
        self._executed = Reading(scenes, "commanded_action", step)
        delivered = self._vehicle_taps.deliver("action", "actuators", self._executed, step)
        return lanes_last(delivered, self._lanes)


def _float_column(state: State) -> State:
    """Single precision, a candidate axis at the end, and attitudes that are rotations again.

    A fault may have added noise to the attitude; a reading that is a rotation already comes out
    of the projection changed by rounding only, so it is left alone.
    """
    narrow = state.to(torch.float32)
    off = so3.compose(narrow.rotation.transpose(0, 1), narrow.rotation)
    off = (off - torch.eye(3, device=off.device)[..., None]).abs().amax((0, 1)) > 1e-4
    rotation = narrow.rotation
    if not at_hand(off.device) or off.any():
        rotation = torch.where(off, so3.project(rotation), rotation)
    return State(
        narrow.position[..., None],
        narrow.velocity[..., None],
        rotation[..., None],
        narrow.rate[..., None],
    )


def _physics(values: Tensor) -> Physics:
    return Physics(
        inertia_kgm2=values[0:3],
        torque_scale=values[3],
        motor_time_constant_s=values[4],
        drag_kgps=values[5:8],
        collective_thrust_n=values[8],
    )
