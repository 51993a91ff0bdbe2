"""Fitting the clearance model: its images and its loss."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from torch import LongTensor, Tensor, nn
from torch.nn import functional
from typing_extensions import override

from faultpath.plugin.system import generator
from faultpath.plugin.training import Schedule
from faultpath_quadrotor.perception.clearance import ClearanceModel
from faultpath_quadrotor.perception.labels import HIGHEST_M, LOWEST_M
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.training import clearance_data
from faultpath_quadrotor.training.catalogue import CLEARANCE_POOL
from faultpath_quadrotor.training.clearance_data import ClearanceRecipe, Samples
from faultpath_quadrotor.training.fitting import ModelTask
from faultpath_quadrotor.training.pool import pools_sha256

VALIDATION_FROM = 90
"""Scenes of the training library from here on are never trained on: two of each topology."""
POINTS = 96
"""Points of an image that a minibatch takes, drawn anew each epoch."""
KINK_M = 0.05
"""Error at which the loss turns from quadratic to linear."""

_CHUNK = 128


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
        self.use(clearance_data.read(clearance_data.collect(self._folder, self._recipe, workers=0)))

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
    estimates = []
    for first in range(0, len(samples), _CHUNK):
        part = samples.take(torch.arange(first, min(first + _CHUNK, len(samples))))
        estimates.append(model.query(model.encode(part.depth_m()), part.points.movedim(1, 0)))
    return torch.cat(estimates)


def _mirror(depth: Tensor, points: Tensor, mirrored: Tensor) -> tuple[Tensor, Tensor]:
    """Swap left and right in some images `[b, 36, 64]` and their points `[b, 3, P]`."""
    depth = torch.where(mirrored[:, None, None], depth.flip(2), depth)
    side = torch.where(mirrored, -1.0, 1.0)
    scale = torch.stack((torch.ones_like(side), side, torch.ones_like(side)), 1)
    return depth, points * scale[..., None]
