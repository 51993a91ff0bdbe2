"""The quadrotor as a system that can be audited."""

import json
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Self

import torch
from typing_extensions import override

from faultpath.faults import FaultPreset
from faultpath.interface import Interface
from faultpath.loop import Deliverer, Loop, Module, Part, Plant
from faultpath.plugin.system import UserError
from faultpath.system import VEHICLE, FloorPlan, Library, LoopSystem, Outcome, SceneRef
from faultpath_quadrotor import native
from faultpath_quadrotor.choices import (
    ESTIMATORS,
    INERTIAL,
    ClearanceName,
    DeviceName,
    calibration,
    mount,
    noisy_state,
)
from faultpath_quadrotor.device import CPU, arithmetic, describe
from faultpath_quadrotor.estimators import Estimator
from faultpath_quadrotor.estimators.protocol import with_estimators
from faultpath_quadrotor.estimators.sensors import SENSORS, sensors
from faultpath_quadrotor.interface import quadrotor_interface
from faultpath_quadrotor.models import clearance_model, estimator, reconstruction, shipped_folder
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.perception import DepthClearance, DepthRenderer
from faultpath_quadrotor.perception.module import Perception
from faultpath_quadrotor.planners.module import PlannerModule
from faultpath_quadrotor.plant import TorchPlant
from faultpath_quadrotor.plant.module import VehiclePlant, World
from faultpath_quadrotor.plant.protocol import Vehicle
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.reconstruction.base import WindModule
from faultpath_quadrotor.scenes.field import DistanceField
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.scenes.prisms import floor_plan
from faultpath_quadrotor.scenes.scene import Scene
from faultpath_quadrotor.user_parts import load_user_parts
from faultpath_quadrotor.variants import modelled, variants
from faultpath_quadrotor.vehicle import CONTROL_DT_S


class Quadrotor(LoopSystem):
    """Flies a block of scenes with the modules under test behind taps."""

    name = "quadrotor"
    trained = True
    control_dt_s = CONTROL_DT_S
    metrics = VEHICLE
    more_signals = "faultpath_quadrotor.signals:quadrotor_signals"

    def __init__(self, options: QuadrotorOptions) -> None:
        self.options = options
        self.parallel = options.device is DeviceName.CPU
        self.block_size = 50 if self.parallel else 100  # a GPU takes a library
        self._scenes: dict[str, Scene] = {}
        self.user_parts = load_user_parts(options.parts, options.sampling)
        self.variant_parts = {v.name: v for v in variants(options, self.user_parts)}

    @classmethod
    def parse(cls, **options: str) -> Self:
        """Return the system of some options; see `QuadrotorOptions.parse`."""
        return cls(QuadrotorOptions.parse(**options))

    @property
    def interface(self) -> Interface:
        """See `System.interface`; the clearance is queried along the planner's candidates."""
        sampling = self.options.sampling
        horizon, candidates = sampling.horizon, sampling.candidates
        clearance = dict.fromkeys(("estimated_clearance", "true_clearance"), (horizon, candidates))
        shapes = {**clearance, "predicted_motion": (6, horizon, candidates)}
        shaped = quadrotor_interface().shaped(shapes)
        return with_estimators(shaped, self._sensing, self.options.fixes)

    @property
    @override
    def fault_presets(self) -> Mapping[str, FaultPreset]:
        always = {"calibration": calibration, "noisy_state": noisy_state}
        return always | ({"mount": mount} if self.options.filtered else {})

    @property
    def _sensing(self) -> Sequence[Part]:
        """Parts that may read raw sensors."""
        own = [part.blank for part in self.user_parts.values()]
        estimators = [part for part in own if isinstance(part, Estimator)]
        if not self.options.filtered:
            return estimators
        inertial = WindModule(reconstruction(INERTIAL, None), CPU)
        return (*map(estimator, ESTIMATORS), inertial, *estimators)

    def library(self, name: str) -> Library:
        """See `System.library`; a library from a file is named by its path, to be loaded again."""
        library = load_library(name)
        self._scenes |= {s.id: PLATFORM.scene(s) for s in library.scenes}
        refs = tuple(SceneRef(s.id, s.index, s.topology) for s in library.scenes)
        return Library(name, refs, library.content_hash)

    @override
    def floor_plan(self, scene: str) -> FloorPlan:
        return floor_plan(self.scene(scene), free_space=self.options.free_space)

    @property
    @override
    def backend(self) -> str:
        options = self.options
        computes = (
            native.describe() if options.device is DeviceName.CPU else describe(options.device)
        )
        return computes + ("" if options.plant == "torch" else f", the plant {options.plant}")

    def fingerprint(self) -> str:
        """See `System.fingerprint`: the kernels' arithmetic on this machine, and the options."""
        options = self.options.model_dump(mode="json")
        return json.dumps({"kernels": native.numerics(), "options": options}, sort_keys=True)

    @property
    def data_files(self) -> Sequence[Path]:
        """See `System.data_files`: interface, weights and their cards, the kernels' sources."""
        own = (file for part in self.user_parts.values() for file in part.data_files)
        folder = shipped_folder()
        weights = sorted((*folder.glob("*.json"), *folder.glob("*.safetensors")))
        return (*weights, Path("interface.yaml"), Path("native/source"), *own)

    @property
    @override
    def parts(self) -> Sequence[str]:
        return tuple(self.user_parts)

    @property
    @override
    def descriptions(self) -> Mapping[str, str]:
        return {name: parts.description for name, parts in self.variant_parts.items()}

    @override
    def bindings(self, variant: str) -> Mapping[str, str]:
        return self.variant_parts[variant].bindings(self.options)

    @override
    def plant(self) -> Plant:
        options, free, place = self.options, self.options.free_space, self.options.place
        own = self.user_parts.get(options.plant)
        reads = {port.channel for reader in self._sensing for port in reader.ports}
        known = sensors(options.fixes)
        needed = {name: known[name] for name in SENSORS if name in reads}

        def world(scenes: Sequence[str]) -> World:
            records, winds = self._records(scenes), PLATFORM.winds
            plant = TorchPlant if own is None else own.load(None)
            return World(records, options.wind, free, place, plant, winds, sampled=bool(needed))

        def camera(scenes: Sequence[str]) -> DepthRenderer:
            return _renderer(self._records(scenes), free, place)

        def field(scenes: Sequence[str]) -> DistanceField:
            return _field(self._records(scenes), free, place)

        if options.clearance is ClearanceName.TRUE:
            return VehiclePlant(world, None, field, needed, options.sensor_noise)
        return VehiclePlant(world, camera, None, needed, options.sensor_noise)

    @override
    def modules(self, variant: str, seed: int | None) -> Sequence[Module]:
        parts, place = self.variant_parts[variant], self.options.place
        modules = modelled(
            parts.load_predictor(seed, place),
            parts.load_reconstruction(seed, place),
            place,
            parts.load_estimator(seed, self.options),
        )
        planner = parts.load_planner(seed, self.options)
        modules.append(PlannerModule(planner, place, self._hover_command))
        if self.options.clearance is not ClearanceName.TRUE:
            modules.append(
                Perception(
                    lambda: DepthClearance(clearance_model(place), place, PLATFORM.perception)
                )
            )
        return modules

    @arithmetic()
    @torch.inference_mode()
    @override
    def execute(
        self, loop: Loop, scenes: Sequence[str], taps: Deliverer, seed: int
    ) -> list[Outcome]:
        return super().execute(loop, scenes, taps, seed)

    def _hover_command(self, scenes: Sequence[str]) -> torch.Tensor:
        """Return the command under which each scene's vehicle hovers, `[B, 4]`."""
        return Vehicle.stack([s.vehicle for s in self._records(scenes)]).hover_command().T

    def _records(self, scenes: Sequence[str]) -> tuple[Scene, ...]:
        return tuple(self.scene(scene) for scene in scenes)

    def scene(self, scene: str) -> Scene:
        """Return a scene of a library that was loaded before, or of a frozen one."""
        if scene not in self._scenes:
            self.library(scene.rpartition("/")[0])
        if scene not in self._scenes:
            raise UserError(f"there is no scene '{scene}' in its libraries.")
        return self._scenes[scene]


@lru_cache(maxsize=4)  # a library's blocks; each treatment flies over the same ones
def _field(scenes: tuple[Scene, ...], free_space: bool, place: torch.device) -> DistanceField:
    return DistanceField.bake(scenes, free_space, device=place)


@lru_cache(maxsize=4)
def _renderer(scenes: tuple[Scene, ...], free_space: bool, place: torch.device) -> DepthRenderer:
    return DepthRenderer(scenes, free_space, place)
