"""The quadrotor as a system that can be audited."""

import json
import math
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from pathlib import Path
from typing import Self

import torch
from torch import Tensor

from faultpath.errors import UserError
from faultpath.faults import FaultPreset
from faultpath.interface import Interface
from faultpath.quadrotor import native
from faultpath.quadrotor.checkpoint import shipped_folder
from faultpath.quadrotor.choices import ClearanceName, DeviceName
from faultpath.quadrotor.clearance import ClearanceSource, SeenClearance, TrueClearance
from faultpath.quadrotor.device import CPU, arithmetic, describe
from faultpath.quadrotor.flight import Flight
from faultpath.quadrotor.interface import quadrotor_interface
from faultpath.quadrotor.models import clearance_model
from faultpath.quadrotor.navigator import Navigator, WindReconstruction
from faultpath.quadrotor.options import QuadrotorOptions
from faultpath.quadrotor.perception import DepthClearance, DepthRenderer
from faultpath.quadrotor.presets import calibration, noisy_state
from faultpath.quadrotor.scenes.draw import floor_plan
from faultpath.quadrotor.scenes.field import DistanceField
from faultpath.quadrotor.scenes.library import load_library
from faultpath.quadrotor.scenes.scene import Scene
from faultpath.quadrotor.variants import variant, wirings
from faultpath.quadrotor.vehicle import CONTROL_DT_S
from faultpath.quadrotor.world import World
from faultpath.taps import Taps
from faultpath.trials import FloorPlan, Library, Outcome, SceneRef, Status, System, Variant


class Quadrotor(System):
    """Flies a block of scenes with the modules under test behind taps."""

    name = "quadrotor"
    trained = True
    control_dt_s = CONTROL_DT_S

    def __init__(self, options: QuadrotorOptions) -> None:
        self.options = options
        self.parallel = options.device is DeviceName.CPU
        self.block_size = 50 if self.parallel else 100  # a GPU takes a library
        self._scenes: dict[str, Scene] = {}
        self._wirings = {wiring.name: wiring for wiring in wirings(options)}
        self._variants = {
            name: variant(wiring, quadrotor_interface(), options)
            for name, wiring in self._wirings.items()
        }

    @classmethod
    def parse(cls, **options: str) -> Self:
        """Return the system of some options; see `QuadrotorOptions.parse`."""
        return cls(QuadrotorOptions.parse(**options))

    @property
    def interface(self) -> Interface:
        """See `System.interface`; the clearance is asked for along the planner's candidates."""
        shape = (self.options.settings.sampler.horizon, self.options.candidates)
        return quadrotor_interface().shaped(
            dict.fromkeys(("estimated_clearance", "true_clearance"), shape)
        )

    @property
    def variants(self) -> Mapping[str, Variant]:
        """See `System.variants` and `faultpath.quadrotor.variants`."""
        return self._variants

    @property
    def fault_presets(self) -> Mapping[str, FaultPreset]:
        """See `System.fault_presets`."""
        return {"calibration": calibration, "noisy_state": noisy_state}

    def library(self, name: str) -> Library:
        """See `System.library`; a file's library keeps its path for a name, to be found again."""
        library = load_library(name)
        self._scenes.update({scene.id: scene for scene in library.scenes})
        refs = tuple(SceneRef(s.id, s.index, s.topology) for s in library.scenes)
        return Library(name, refs, library.content_hash)

    def floor_plan(self, scene: str) -> FloorPlan:
        """See `System.floor_plan`."""
        return floor_plan(self.scene(scene), free_space=self.options.free_space)

    @property
    def backend(self) -> str:
        """See `System.backend`."""
        device = self.options.device
        return native.describe() if device is DeviceName.CPU else describe(device)

    def fingerprint(self) -> str:
        """See `System.fingerprint`: the kernels' arithmetic on this machine, and the options."""
        options = self.options.model_dump(mode="json")
        return json.dumps({"kernels": native.numerics(), "options": options}, sort_keys=True)

    @property
    def data_files(self) -> Sequence[Path]:
        """See `System.data_files`: the interface, the weights, and what kernels are built from."""
        return (*_weights(), Path("interface.yaml"), Path("native/source"))

    @arithmetic()
    @torch.inference_mode()
    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> list[Outcome]:
        """See `System.run`."""
        flight = self.flight(variant, scenes, taps, seed)
        world = flight.world
        trace = [world.state.position for _ in flight.commands()]
        trace.append(world.state.position)
        return _outcomes(scenes, world, torch.stack(trace), flight.navigator.noise_hashes())

    def flight(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> Flight:
        """Return a flight over some scenes, ready to start."""
        records = [self.scene(scene) for scene in scenes]
        options = self.options
        world = World(records, options.wind, options.free_space, options.place)
        navigator = self._navigator(variant, records, taps, seed, world)
        return Flight(world, navigator, self._camera(records), taps)

    def _camera(self, scenes: list[Scene]) -> DepthRenderer | None:
        if self.options.clearance is ClearanceName.TRUE:
            return None
        return _renderer(tuple(scenes), self.options.free_space, self.options.place)

    def _navigator(
        self, variant: str, scenes: list[Scene], taps: Taps, seed: int, world: World
    ) -> Navigator:
        wiring = self._wirings[variant]
        place = self.options.place
        module = wiring.load_reconstruction(seed, place)
        return Navigator(
            planner=self.options.build_planner(wiring.load_predictor(seed, place)),
            reconstruction=module
            and WindReconstruction(module, taps.for_module("reconstruction"), world.lanes),
            clearance=self._clearance(scenes, taps),
            taps=taps,
            scenes=[scene.id for scene in scenes],
            seed=seed,
            lanes=world.lanes,
        )

    def _clearance(self, scenes: list[Scene], taps: Taps) -> ClearanceSource:
        place = self.options.place
        if self.options.clearance is ClearanceName.TRUE:
            return TrueClearance(_field(tuple(scenes), self.options.free_space, place))
        model = DepthClearance(clearance_model(place), place)
        return SeenClearance(model, taps.for_module("perception"))

    def scene(self, scene: str) -> Scene:
        """Return a scene of a library that was asked for before, or of a frozen one."""
        if scene not in self._scenes:
            self.library(scene.rpartition("/")[0])
        if scene not in self._scenes:
            raise UserError(f"there is no scene '{scene}': `faultpath scenes list` shows them.")
        return self._scenes[scene]


def _outcomes(
    scenes: Sequence[str], world: World, positions: Tensor, noise: Sequence[str]
) -> list[Outcome]:
    """`positions` is `[T, 3, L]`, at the start and after each control step.

    This waits for the device, once a block.
    """
    end, positions = world.progress.to(CPU), positions.to(CPU)
    outcomes: list[Outcome] = []
    for i, scene in enumerate(scenes):
        time_s = float(end.time_s[i])
        steps = math.ceil(time_s / CONTROL_DT_S - 1e-6)
        status = Status.SUCCESS if end.succeeded[i] else Status.TIMEOUT
        outcomes.append(
            Outcome(
                scene=scene,
                status=Status.CRASH if end.crashed[i] else status,
                time_s=time_s,
                terminal_distance_m=float(end.terminal_distance_m[i]),
                min_clearance_m=float(end.min_clearance_m[i]),
                initial_hash=world.initial_hashes[i],
                disturbance_hash=world.wind_hashes[i],
                planner_noise_hash=noise[i],
                trace=positions[: steps + 1, :, i].float().numpy(),
            )
        )
    return outcomes


@cache
def _weights() -> tuple[Path, ...]:
    """Return the weights of the package; their cards decide nothing."""
    return tuple(sorted(shipped_folder().glob("*.safetensors")))


@lru_cache(maxsize=4)  # a library's blocks; each arm flies over the same ones
def _field(scenes: tuple[Scene, ...], free_space: bool, place: torch.device) -> DistanceField:
    return DistanceField.bake(scenes, free_space, device=place)


@lru_cache(maxsize=4)
def _renderer(scenes: tuple[Scene, ...], free_space: bool, place: torch.device) -> DepthRenderer:
    return DepthRenderer(scenes, free_space, place)
