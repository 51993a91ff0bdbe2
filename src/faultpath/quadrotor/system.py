"""The quadrotor as a system that can be audited."""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from importlib.resources import files

import torch
from torch import Tensor

from faultpath.errors import UserError
from faultpath.faults import FaultPreset
from faultpath.interface import Interface, read_interface
from faultpath.quadrotor.calibration import calibration
from faultpath.quadrotor.navigator import Navigator, WindObserver
from faultpath.quadrotor.options import Environment, PredictorName, QuadrotorOptions
from faultpath.quadrotor.reconstruction import DisturbanceObserver
from faultpath.quadrotor.scenes.draw import floor_plan
from faultpath.quadrotor.scenes.field import DistanceField
from faultpath.quadrotor.scenes.library import load_library
from faultpath.quadrotor.scenes.scene import Scene
from faultpath.quadrotor.sensors import Sensors
from faultpath.quadrotor.vehicle import CONTROL_DT_S
from faultpath.quadrotor.world import CONTROL_STEPS, World
from faultpath.taps import Taps
from faultpath.trials import FloorPlan, Library, Outcome, SceneRef, Status, System, Variant


def create(**options: str) -> System:
    """Build the quadrotor from options of the command line; `UserError` for a wrong one."""
    torch.set_num_threads(1)  # a block is small: a second thread costs more than it brings
    return Quadrotor(QuadrotorOptions.parse(**options))


class Quadrotor(System):
    """Flies a block of scenes with the modules under test behind taps."""

    name = "quadrotor"
    control_dt_s = CONTROL_DT_S
    block_size = 25

    def __init__(self, options: QuadrotorOptions) -> None:
        self.options = options
        self._scenes: dict[str, Scene] = {}
        self._variants = {v.name: v for v in _variants(_interface(), options)}

    @property
    def interface(self) -> Interface:
        """See `System.interface`."""
        return _interface()

    @property
    def variants(self) -> Mapping[str, Variant]:
        """Zero wind, observed wind and true wind, all with ground-truth clearance."""
        return self._variants

    @property
    def fault_presets(self) -> Mapping[str, FaultPreset]:
        """See `System.fault_presets`."""
        return {"calibration": calibration}

    def library(self, name: str) -> Library:
        """See `System.library`; a file's library keeps its path for a name, to be found again."""
        library = load_library(name)
        self._scenes.update({scene.id: scene for scene in library.scenes})
        refs = tuple(SceneRef(s.id, s.index, s.topology) for s in library.scenes)
        return Library(name, refs, library.content_hash)

    def floor_plan(self, scene: str) -> FloorPlan:
        """See `System.floor_plan`."""
        return floor_plan(self._scene(scene), free_space=self._free_space)

    def fingerprint(self) -> str:
        """See `System.fingerprint`."""
        content = {
            "code": _code_digest(),
            "options": self.options.model_dump(mode="json"),
        }
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]

    @torch.inference_mode()
    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> list[Outcome]:
        """See `System.run`."""
        records = [self._scene(scene) for scene in scenes]
        world = World(records, self.options.wind, self._free_space)
        navigator = self._navigator(variant, records, taps, seed, world)
        trace = [world.state.position]
        for step in range(CONTROL_STEPS):
            running = world.progress.running[: world.count]
            taps.set_active(running.numpy())
            command = navigator.act(Sensors.read(world), step, running.nonzero()[:, 0].tolist())
            world.advance(command)
            trace.append(world.state.position)
            if not world.progress.running[: world.count].any():
                break
        return _outcomes(scenes, world, torch.stack(trace), navigator.noise_hashes())

    def _navigator(
        self, variant: str, scenes: list[Scene], taps: Taps, seed: int, world: World
    ) -> Navigator:
        consumers = self.variants[variant].consumers
        observer = None
        if any(name.startswith("observer.") for name in consumers):
            observer = WindObserver(DisturbanceObserver(), taps.for_module("observer"), world.lanes)
        return Navigator(
            planner=self.options.build_planner(),
            observer=observer,
            field=_field(tuple(scenes), self._free_space),
            taps=taps,
            scenes=[scene.id for scene in scenes],
            seed=seed,
            lanes=world.lanes,
            wind_source=self.variants[variant].bindings["wind"],
            privileged_physics="predictor.physics" in consumers,
        )

    @property
    def _free_space(self) -> bool:
        return self.options.environment is Environment.FREE_SPACE

    def _scene(self, scene: str) -> Scene:
        """Return a scene of a library that was asked for before, or of a frozen one."""
        if scene not in self._scenes:
            self.library(scene.rpartition("/")[0])
        if scene not in self._scenes:
            raise UserError(f"there is no scene '{scene}': `faultpath scenes list` shows them.")
        return self._scenes[scene]


def _outcomes(
    scenes: Sequence[str], world: World, positions: Tensor, noise: Sequence[str]
) -> list[Outcome]:
    """`positions` is `[T, 3, L]`, at the start and after each control step."""
    end = world.progress
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
def _code_digest() -> str:
    """Hash of every file that decides a trial: results of two codes never mix in a folder."""
    package = files("faultpath")
    parts = [package / name for name in ("quadrotor", "taps", "faults", "arrays.py", "streams.py")]
    digest = hashlib.sha256()
    while parts:
        part = parts.pop()
        if part.is_dir():
            parts += sorted(part.iterdir(), key=lambda child: child.name)
        elif part.name.endswith((".py", ".yaml")):
            digest.update(part.name.encode() + part.read_bytes())
    return digest.hexdigest()


@cache
def _interface() -> Interface:
    return read_interface(files("faultpath.quadrotor").joinpath("interface.yaml").read_text())


@lru_cache(maxsize=4)  # a library's blocks; each arm flies over the same ones
def _field(scenes: tuple[Scene, ...], free_space: bool) -> DistanceField:
    return DistanceField.bake(scenes, free_space)


def _variants(interface: Interface, options: QuadrotorOptions) -> list[Variant]:
    """A variant reads everything but the observer's taps, unless the observer feeds it."""
    every = {consumer for channel in interface.channels for consumer in channel.consumers}
    privileged = {"true_clearance"}
    if options.predictor is PredictorName.TRUE_PARAMETER:
        privileged.add("true_physics")
    else:
        every.discard("predictor.physics")
    plain = frozenset(name for name in every if not name.startswith("observer."))
    return [
        Variant(
            "zero-wind",
            "The predictor's wind input is held at zero.",
            plain,
            {"wind": "zero_wind"},
            frozenset(privileged),
        ),
        Variant(
            "observer",
            "The disturbance observer supplies the wind.",
            frozenset(every),
            {"wind": "observed_wind"},
            frozenset(privileged),
        ),
        Variant(
            "true-wind",
            "The simulator's wind at this moment is supplied: a privileged reference.",
            plain,
            {"wind": "true_wind"},
            frozenset(privileged | {"true_wind"}),
        ),
    ]
