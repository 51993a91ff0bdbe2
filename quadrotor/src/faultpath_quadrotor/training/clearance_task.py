"""The clearance model: its images and labelled points, made scene by scene, and how it is fitted.

Poses are as flown: anywhere the vehicle fits, any heading, level as the camera's mount. Points lie
where the planner asks: over the field of view, close to what is seen, and all round the vehicle.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import LongTensor, Tensor, nn
from torch.nn import functional
from typing_extensions import override

from faultpath.plugin.system import Frozen, generator
from faultpath.plugin.training import Schedule
from faultpath_quadrotor import native, so3
from faultpath_quadrotor.perception.camera import HEIGHT, WIDTH, rays
from faultpath_quadrotor.perception.clearance import ClearanceModel
from faultpath_quadrotor.perception.labels import HIGHEST_M, LOWEST_M, visible_distance
from faultpath_quadrotor.perception.render import DepthRenderer
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.scenes.scene import Scene
from faultpath_quadrotor.state import State
from faultpath_quadrotor.training import CLEARANCE_POOL
from faultpath_quadrotor.training.fitting import ModelTask
from faultpath_quadrotor.training.pool import (
    PoolPart,
    PoolRecipe,
    Progress,
    code_of,
    make_pool,
    pools_sha256,
    read_pool,
)
from faultpath_quadrotor.vehicle import COLLISION_RADIUS_M

PER_METRE = 10_000
"""Depths are stored in tenths of a millimetre, 16 bits each."""
VALIDATION_FROM = 90
"""Scenes of the training library from here on are never trained on: two of each topology."""
POINTS = 96
"""Points of an image that a minibatch takes, drawn anew each epoch."""
KINK_M = 0.05
"""Error at which the loss turns from quadratic to linear."""
_CHUNK = 128


class ClearanceRecipe(Frozen):
    """Settings that decide every number of the data set."""

    library: str = "training"
    images: int = 200
    """Images a scene."""
    in_view: int = 128
    """Points an image that are spread over the field of view and a little beyond it."""
    near_surface: int = 128
    """Points about what random pixels see, or about their rays where that is beyond `depth_m`."""
    around: int = 64
    """Points all round the vehicle."""
    height_m: tuple[float, float] = (0.4, 2.5)
    depth_m: float = 4.5
    """Depth to which points are spread: what a second at the top speed reaches, and a margin."""
    scatter_m: float = 0.35
    """Standard deviation of the points about the surface."""
    around_m: float = 2.0
    seed: int = 0

    @property
    def points(self) -> int:
        """Points an image."""
        return self.in_view + self.near_surface + self.around


@dataclass(frozen=True)
class Samples:
    """Images with their labelled points."""

    depth: Tensor  # z-depth, `[I, 36, 64]`, uint16, tenths of a millimetre
    points: Tensor  # in the capture frame, `[I, 3, Q]`, m
    clearance: Tensor  # visible-space signed distance, `[I, Q]`, m
    scene: Tensor  # index of each image's scene in its library, `[I]`

    def __len__(self) -> int:
        return len(self.depth)

    def tensors(self) -> dict[str, Tensor]:
        """Return what a pool keeps."""
        return vars(self)

    def take(self, index: Tensor) -> "Samples":
        """Return some of the images."""
        return Samples(**{name: part[index] for name, part in vars(self).items()})

    def depth_m(self) -> Tensor:
        """Return the images in metres, float32."""
        return self.depth.float() / PER_METRE


def collect(
    folder: Path,
    settings: ClearanceRecipe | None = None,
    workers: int = 2,
    progress: Progress | None = None,
) -> Path:
    """Make the data set in `folder` and return its file; see `make_pool`."""
    settings = settings or ClearanceRecipe()
    parts = [
        PoolPart(f"{scene.index:03d}", 1, partial(draw, settings, scene))
        for scene in load_library(settings.library).scenes
    ]
    return make_pool(folder, recipe(settings), parts, workers, progress)


def recipe(settings: ClearanceRecipe | None = None) -> PoolRecipe:
    """Return what decides the data set's numbers."""
    settings = settings or ClearanceRecipe()
    library = load_library(settings.library)
    return PoolRecipe(
        pool=CLEARANCE_POOL,
        episodes=len(library.scenes),
        seed=settings.seed,
        code_sha256=code_of(),
        settings={**settings.model_dump(mode="json"), "library_sha": library.content_hash},
    )


def read(path: Path) -> Samples:
    """Return a data set that `collect` made; `UserError` when it is missing or damaged."""
    return Samples(**read_pool(path)[1])


@native.using(native.PORTABLE)
def draw(recipe: ClearanceRecipe, scene: Scene) -> Samples:
    """Return the images and labelled points of one scene."""
    random = generator("clearance-data", scene.id, recipe.seed)
    state = _poses(recipe, scene, random)
    renderer = DepthRenderer([scene] * recipe.images)
    stored = (renderer.render(state) * PER_METRE).round().to(torch.uint16)
    images = stored.float() / PER_METRE
    points = torch.stack([_points(recipe, image, random) for image in images])
    clearance = [visible_distance(*pair) for pair in zip(images, points, strict=True)]
    return Samples(
        depth=stored,
        points=points,
        clearance=torch.stack(clearance).float(),
        scene=torch.full((recipe.images,), scene.index),
    )


def _poses(recipe: ClearanceRecipe, scene: Scene, random: np.random.Generator) -> State:
    """Draw poses at which the vehicle touches nothing."""
    low, high = np.array(scene.bounds.low_m), np.array(scene.bounds.high_m)
    low[2], high[2] = recipe.height_m
    geometry = Geometry.stack([scene])
    positions = torch.empty(3, 0, dtype=torch.float64)
    while positions.shape[1] < recipe.images:
        drawn = torch.from_numpy(random.uniform(low, high, (recipe.images, 3)).T.copy())
        free = geometry.distance(drawn[:, None])[0] > COLLISION_RADIUS_M
        positions = torch.cat((positions, drawn[:, free]), 1)
    position = positions[:, : recipe.images]
    rotation = so3.from_yaw(torch.from_numpy(random.random(recipe.images)) * 2 * np.pi)
    return State(position, torch.zeros_like(position), rotation, torch.zeros_like(position))


def _points(recipe: ClearanceRecipe, image: Tensor, random: np.random.Generator) -> Tensor:
    """Draw points of one image `[3, Q]`, in the capture frame."""
    seen = rays().flatten(1).numpy()
    spread = random.uniform(-1, 1, (2, recipe.in_view)) * np.abs(seen[1:]).max(1)[:, None] * 1.15
    depth = random.uniform(0.05, recipe.depth_m, recipe.in_view)
    over_view = np.concatenate((depth[None], depth * spread))

    pixel = random.integers(0, HEIGHT * WIDTH, recipe.near_surface)
    at = np.minimum(image.flatten().numpy()[pixel], recipe.depth_m)
    about = seen[:, pixel] * at + random.normal(0, recipe.scatter_m, (3, pixel.size))

    direction = random.normal(size=(3, recipe.around))
    direction /= np.linalg.norm(direction, axis=0)
    around = direction * random.uniform(0, recipe.around_m, recipe.around)
    return torch.from_numpy(np.concatenate((over_view, about, around), 1)).float()


class ClearanceTask(ModelTask):
    """One clearance model: absolute error of the truncated distance, censored at its bounds.

    Where the label is at a bound, an estimate beyond it is right as well, because it is clipped
    in use: the network need not level off by itself. Half of the images are mirrored each epoch,
    left to right with their points, since no scene prefers a side.
    """

    name = order_key = "clearance"

    def __init__(self, seed: int, data_folder: Path, recipe: ClearanceRecipe | None = None) -> None:
        self.seed = seed
        self.platform = PLATFORM.weights_hash(self.name)
        self.schedule = Schedule(epochs=50, batch_size=64, learning_rate=5e-4)
        self._folder = data_folder
        self._recipe = recipe or ClearanceRecipe()

    def load(self) -> None:
        """Read the images; make them first where they are missing."""
        self.use(read(collect(self._folder, self._recipe, workers=0)))

    def use(self, samples: Samples) -> None:
        """Take samples from memory, split by scene."""
        kept = samples.scene < VALIDATION_FROM
        self._training = samples.take(kept.nonzero()[:, 0])
        self._validation = samples.take((~kept).nonzero()[:, 0])
        self.count = len(self._training)
        self._mirrored = torch.empty(0)
        self._chosen = torch.empty(0)

    @override
    def module(self) -> nn.Module:
        model = ClearanceModel()
        stream = generator("initial weights", self.name, self.seed)
        model.initialise(torch.Generator().manual_seed(int(stream.integers(2**62))))
        return model

    def begin_epoch(self, epoch: int) -> None:
        """Draw which images are mirrored and which of their points count."""
        random = generator("clearance augmentation", self.name, self.seed, epoch)
        shape = (self.count, min(POINTS, self._recipe.points))
        self._mirrored = torch.from_numpy(random.random(self.count) < 0.5)
        self._chosen = torch.from_numpy(random.integers(0, self._recipe.points, shape))

    @override
    def loss(self, net: nn.Module, index: LongTensor) -> Tensor:
        assert isinstance(net, ClearanceModel)
        batch, chosen = self._training.take(index), self._chosen[index]
        depth, points = _mirror(
            batch.depth_m(),
            batch.points.gather(2, chosen[:, None].expand(-1, 3, -1)),
            self._mirrored[index],
        )
        estimate = net.estimate(net.encode_batch(depth), points)
        return censored_loss(estimate, batch.clearance.gather(1, chosen))

    def validate(self, net: nn.Module) -> Mapping[str, float]:
        """Return errors on scenes that were never trained on, those between the bounds first."""
        assert isinstance(net, ClearanceModel)
        truth = self._validation.clearance
        error = predict(net, self._validation).sub_(truth)
        between = error[(truth > LOWEST_M) & (truth < HIGHEST_M)].abs()
        wrong = (error + truth > 0) != (truth > 0)
        return {
            "error_m": float(between.mean()),
            "median_error_m": float(between.median()),
            "error_everywhere_m": float(error.abs().mean()),
            "wrong_sign": float(wrong.float().mean()),
        }

    @override
    def describe(self) -> Mapping[str, Any]:
        return {
            "description": "obstacle clearance from depth",
            "data_sha256": pools_sha256(self._folder, [CLEARANCE_POOL]),
            "recipe": self._recipe.model_dump(mode="json"),
            "points_in_a_minibatch": POINTS,
            "kink_m": KINK_M,
            "validation_from_scene": VALIDATION_FROM,
        }


def censored_loss(estimate: Tensor, truth: Tensor) -> Tensor:
    """Return the mean smooth absolute error; beyond a bound that the truth is at costs nothing."""
    error = estimate - truth
    error = torch.where(truth >= HIGHEST_M, error.clamp(max=0), error)
    error = torch.where(truth <= LOWEST_M, error.clamp(min=0), error)
    return functional.smooth_l1_loss(error, torch.zeros_like(error), beta=KINK_M)


@torch.no_grad()
def predict(model: ClearanceModel, samples: Samples) -> Tensor:
    """Return the model's clearance at all points of all images, `[I, Q]`, m."""
    parts = map(samples.take, torch.arange(len(samples)).split(_CHUNK))
    estimates = (model.query(model.encode(p.depth_m()), p.points.movedim(1, 0)) for p in parts)
    return torch.cat(list(estimates))


def _mirror(depth: Tensor, points: Tensor, mirrored: Tensor) -> tuple[Tensor, Tensor]:
    """Swap left and right in some images `[b, 36, 64]` and their points `[b, 3, P]`."""
    depth = torch.where(mirrored[:, None, None], depth.flip(2), depth)
    side = torch.where(mirrored, -1.0, 1.0)
    scale = torch.stack((torch.ones_like(side), side, torch.ones_like(side)), 1)
    return depth, points * scale[..., None]
