"""Depth images and labelled points for the clearance model, made scene by scene from its id.

Poses are as flown: anywhere the vehicle fits, any heading, level as the camera's mount. Points lie
where the planner asks: over the field of view, close to what is seen, and all round the vehicle.
"""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from faultpath.plugin.system import Frozen, generator
from faultpath_quadrotor import native, so3
from faultpath_quadrotor.perception.camera import HEIGHT, WIDTH, rays
from faultpath_quadrotor.perception.labels import visible_distance
from faultpath_quadrotor.perception.render import DepthRenderer
from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.scenes.scene import Scene
from faultpath_quadrotor.state import State
from faultpath_quadrotor.training.catalogue import CLEARANCE_POOL
from faultpath_quadrotor.training.pool import (
    PoolPart,
    PoolRecipe,
    Progress,
    code_of,
    make_pool,
    read_pool,
)
from faultpath_quadrotor.vehicle import COLLISION_RADIUS_M

PER_METRE = 10_000
"""Depths are stored in tenths of a millimetre, 16 bits each."""


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
    """Images with their labelled points.

    Attributes:
        depth: z-depth, `[I, 36, 64]`, uint16, tenths of a millimetre.
        points: In the capture frame, `[I, 3, Q]`, m.
        clearance: Visible-space signed distance, `[I, Q]`, m.
        scene: Index of each image's scene in its library, `[I]`.
    """

    depth: Tensor
    points: Tensor
    clearance: Tensor
    scene: Tensor

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
    library = load_library(settings.library)
    parts = [PoolPart(f"{scene.index:03d}", 1, partial(draw, settings, scene)) for scene in library]
    return make_pool(folder, recipe(settings), parts, workers, progress)


def recipe(settings: ClearanceRecipe | None = None) -> PoolRecipe:
    """Return what decides the data set's numbers."""
    settings = settings or ClearanceRecipe()
    library = load_library(settings.library)
    return PoolRecipe(
        pool=CLEARANCE_POOL,
        episodes=len(library),
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
