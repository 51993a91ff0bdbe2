"""The clearance model: a depth image becomes a code, and the code a small network over space.

The image is encoded once a replan into 64 numbers. From them a linear map makes the weights of a
network with two hidden layers that takes a point in the capture frame to its clearance (a
hypernetwork: Ha, Dai and Le 2016). Its first layer is then a set of planes of this scene, and a
query costs no more than with fixed weights: what depends on the code is computed once a scene.
"""

from itertools import pairwise

import torch
from torch import Tensor, nn

from faultpath_quadrotor.device import host_readable
from faultpath_quadrotor.perception.camera import RANGE_M
from faultpath_quadrotor.perception.labels import HIGHEST_M, LOWEST_M

CODE = 64
NEAREST_M, INVERSE_SCALE = 0.2, 0.4
"""The encoder's second input is the inverse depth, finite and about one in size."""
HIDDEN = 48
"""Units of a hidden layer. One of them is constant and carries the next layer's bias."""

_CHANNELS = (16, 32, 48)
_DENSE = 128
_GROUP = 16
"""Images convolved at once. The library picks its algorithm by the batch, so the batch is
always this; within it an image's place does not matter."""
_BLOCK = 2560
"""Points queried at once: both hidden layers stay in the second-level cache. A multiple of 32, as
a matrix product's bits depend on the column's place otherwise."""
_COLUMNS = 32
_SCALE = (0.3, 0.1, 0.15)
"""How much of a layer's weights the code moves at first, layer by layer."""


def features(points: Tensor) -> Tensor:
    """Return what the query network sees of points `[3, *b]` in the capture frame, `[9, *b]`.

    Position, range, where a point projects, and inverse depth and range: planes are affine in
    position, edges of the image in the projection. All are about one in size; the last is one.
    """
    x, y, z = points.unbind(0)
    distance = (x * x).add_(y * y).add_(z * z).sqrt_()
    inverse = x.clamp_min(0).add_(0.25).reciprocal_()
    rows = points.new_empty(9, *x.shape)
    torch.mul(points, 0.5, out=rows[:3])
    rows[0] -= 0.5
    torch.mul(distance, 0.5, out=rows[3]).sub_(0.7)
    torch.sub(inverse, 0.7, out=rows[4])
    torch.mul(points[1:], inverse, out=rows[5:7]).clamp_(-1.5, 1.5)
    distance.add_(0.25).reciprocal_()
    torch.sub(distance, 0.7, out=rows[7])
    rows[8].fill_(1)
    return rows


class ClearanceModel(nn.Module):
    """Encoder of depth images and the query network that their codes make."""

    def __init__(self) -> None:
        super().__init__()
        first, second, third = _CHANNELS
        widths = (9, HIDDEN, HIDDEN, 1)
        self._shapes = [(after - (after == HIDDEN), before) for before, after in pairwise(widths)]
        with torch.random.fork_rng(devices=()):  # layers draw from the process's state when made
            self.encoder = nn.Sequential(
                nn.Conv2d(2, first, 5, stride=2, padding=2),
                nn.ReLU(),
                nn.Conv2d(first, second, 3, stride=2, padding=1),
                nn.ReLU(),
                nn.Conv2d(second, third, 3, stride=2, padding=1),
                nn.ReLU(),
                nn.Flatten(),
                nn.Linear(third * 5 * 8, _DENSE),
                nn.ReLU(),
                nn.Linear(_DENSE, CODE),
            )
            self.layers = nn.ModuleList(nn.Linear(CODE, rows * cols) for rows, cols in self._shapes)

    def initialise(self, generator: torch.Generator) -> None:
        """Draw fresh weights.

        The biases of the layers that make weights are the query network's weights for a blank
        code, drawn after He (2015); the code moves them.
        """
        for module in self.encoder:
            if isinstance(module, nn.Conv2d | nn.Linear):
                nn.init.kaiming_uniform_(module.weight, nonlinearity="relu", generator=generator)
                assert module.bias is not None
                nn.init.zeros_(module.bias)
        for (layer, (_, fan_in)), scale in zip(self.makers(), _SCALE, strict=True):
            nn.init.normal_(layer.weight, std=scale / CODE**0.5, generator=generator)
            nn.init.normal_(layer.bias, std=(2 / fan_in) ** 0.5, generator=generator)

    def encode(self, depth: Tensor) -> Tensor:
        """Return the codes `[64, S]` of images `[S, 36, 64]`, m.

        A scene's code has the same bits in a batch of any size.
        """
        groups = -(-len(depth) // _GROUP)
        padded = depth.new_full((groups * _GROUP, *depth.shape[1:]), RANGE_M)
        padded[: len(depth)] = depth
        codes = [self.encode_batch(group) for group in padded.split(_GROUP)]
        return torch.cat(codes)[: len(depth)].T.contiguous()

    def encode_batch(self, depth: Tensor) -> Tensor:
        """Return the codes `[S, 64]` of a batch; its bits may depend on the batch."""
        inverse = INVERSE_SCALE / depth.clamp_min(NEAREST_M)
        return self.encoder(torch.stack((depth / RANGE_M, inverse), 1))

    def query(self, code: Tensor, points: Tensor) -> Tensor:
        """Return the clearance `[S, N]`, m, in [-0.3, 1], at points of the capture frame.

        `code` is `[64, S]`, `points` `[3, S, N]`, m, N a multiple of 32. A scene's values do not
        depend on the others.
        """
        if not host_readable(points.device):
            return self.estimate(code.T, points.movedim(0, 1)).clamp_(LOWEST_M, HIGHEST_M)
        weights = [_with_constant(layer) for layer in self._networks(code)]
        clearance = points.new_empty(points.shape[1:])
        for scene in range(points.shape[1]):
            ours = [weight[scene] for weight in weights]
            for first in range(0, points.shape[2], _BLOCK):
                block = slice(first, first + _BLOCK)
                hidden = features(points[:, scene, block])
                for weight in ours[:-1]:
                    hidden = torch.mm(weight, hidden).clamp_min_(0)
                clearance[scene, block] = torch.mm(ours[-1], hidden)[0]
        return clearance.clamp_(LOWEST_M, HIGHEST_M)

    def estimate(self, codes: Tensor, points: Tensor) -> Tensor:
        """Return the clearance `[S, N]` before it is bounded, for training: all scenes at once.

        `codes` `[S, 64]` are those of `encode_batch`, `points` are `[S, 3, N]`, m.
        """
        hidden = features(points.movedim(1, 0)).movedim(0, 1)
        ones = torch.ones_like(hidden[:, :1])
        first, second, last = (layer(codes).unflatten(1, shape) for layer, shape in self.makers())
        for weight in (first, second):
            hidden = torch.cat((torch.bmm(weight, hidden).relu(), ones), 1)
        return torch.bmm(last, hidden)[:, 0]

    def makers(self) -> list[tuple[nn.Linear, tuple[int, int]]]:
        """Return the map that makes each layer of the query network, and its outputs and inputs.

        The constant unit of a hidden layer is no output of it, and the last input of the next.
        """
        linear = [layer for layer in self.layers if isinstance(layer, nn.Linear)]
        return list(zip(linear, self._shapes, strict=True))

    def _networks(self, code: Tensor) -> list[Tensor]:
        """Return the query networks that codes `[64, S]` make.

        Each layer's weights are `[S, rows, columns]`, the biases in the last column.
        """
        count = code.shape[1]
        padded = code.new_zeros(CODE, -(-count // _COLUMNS) * _COLUMNS)
        padded[:, :count] = code
        layers = []
        for maker, (rows, columns) in self.makers():
            weights = torch.mm(maker.weight, padded).add_(maker.bias[:, None])[:, :count].T
            layers.append(weights.reshape(count, rows, columns).contiguous())
        return layers


def _with_constant(weights: Tensor) -> Tensor:
    """Add the row that stays one to the weights `[S, rows, columns]` of a hidden layer."""
    count, rows, columns = weights.shape
    if rows == 1:
        return weights
    constant = weights.new_zeros(count, 1, columns)
    constant[..., -1].fill_(1)
    return torch.cat((weights, constant), 1)
