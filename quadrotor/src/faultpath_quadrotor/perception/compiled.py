"""The encoder of depth images, the clearance queries of its codes, and the renderer, compiled."""

import ctypes

import torch
from torch import Tensor, nn

from faultpath_quadrotor.native.kernel_args import BLOCK, Block, Lent, fields, lend, output, pack
from faultpath_quadrotor.native.library import Kernels
from faultpath_quadrotor.perception.camera import FOCAL_PX, HEIGHT, RANGE_M, WIDTH, slopes
from faultpath_quadrotor.perception.clearance import CODE, INVERSE_SCALE, NEAREST_M, ClearanceModel
from faultpath_quadrotor.perception.labels import HIGHEST_M, LOWEST_M

ENCODER_SHAPES = ((16, 2, 5, 5), (32, 16, 3, 3), (48, 32, 3, 3), (128, 48 * 5 * 8), (64, 128))
"""Weights of three convolutions and two dense layers; fixed in `encoder.cpp`."""

_SUMMED = 32
"""Outputs of a dense layer that the kernel sums at once."""


class _Encoder(Block):
    """`Encoder` of `encoder.cpp`."""

    _fields_ = (
        *fields(ctypes.c_void_p, "first second third dense last"),
        *fields(ctypes.c_void_p, "first_bias second_bias third_bias dense_bias last_bias"),
        *fields(ctypes.c_float, "range nearest scale"),
    )


class CompiledEncoder:
    """Encodes depth images one by one, with a copy of a model's weights."""

    def __init__(self, kernels: Kernels, model: ClearanceModel) -> None:
        self._kernels = kernels
        layers = [m for m in model.encoder if isinstance(m, nn.Conv2d | nn.Linear)]
        weights = [layer.weight.detach() for layer in layers]
        biases = [layer.bias.detach() for layer in layers if layer.bias is not None]
        for i, (shape, *parts) in enumerate(zip(ENCODER_SHAPES, weights, biases, strict=True)):
            lend(f"weights of layer {i}", parts[0], *shape)
            lend(f"biases of layer {i}", parts[1], shape[0])
        *convolutions, dense, last = weights
        # The kernel's features have their channels last, the model's flattened ones first.
        turned = dense.unflatten(1, (ENCODER_SHAPES[2][0], -1)).transpose(1, 2).flatten(1)
        laid = [weight.permute(2, 3, 1, 0) for weight in convolutions]
        laid += [w.unflatten(0, (-1, _SUMMED)).transpose(1, 2) for w in (turned, last)]
        copies = [Lent(x.clone(memory_format=torch.contiguous_format)) for x in (*laid, *biases)]
        self._table = _Encoder(*copies, RANGE_M, NEAREST_M, INVERSE_SCALE)

    def __call__(self, depth: Tensor) -> Tensor:
        """Return the codes `[64, S]` of images `[S, 36, 64]`, m."""
        codes = output(CODE, len(depth))
        images = lend("depth", depth.float(), len(depth), HEIGHT, WIDTH)
        self._kernels.call("faultpath_encode", self._table, images, len(depth), codes)
        return codes.tensor


FEATURES, HIDDEN = 8, 47
"""Fixed in `clearance.cpp`, without the constants that carry the biases."""
QUERY_SHAPES = ((HIDDEN, FEATURES + 1), (HIDDEN, HIDDEN + 1), (1, HIDDEN + 1))
"""Outputs and inputs of the layers of a query network; the last input is the bias."""

_NUMBERS = (FEATURES + 1 + HIDDEN + 1 + 1) * (HIDDEN + 1)
"""Numbers of a query network (`Query` in `clearance.cpp`)."""


class _Bounds(Block):
    """`Bounds` of `clearance.cpp`: `near` is squared, `left` and `up` are half the view."""

    _fields_ = fields(ctypes.c_float, "lowest highest unseen near left up")


class CompiledClearance:
    """Capture frame, features, query network and field of view in one pass."""

    def __init__(
        self, kernels: Kernels, model: ClearanceModel, unseen_m: float, near_m: float
    ) -> None:
        """Copy the maps that make a query network from a code."""
        self._kernels = kernels
        view = (WIDTH / 2 / FOCAL_PX, HEIGHT / 2 / FOCAL_PX)
        self._bounds = _Bounds(LOWEST_M, HIGHEST_M, unseen_m, near_m**2, *view)
        rows: list[Tensor] = []
        for (layer, _), (outputs, inputs) in zip(model.makers(), QUERY_SHAPES, strict=True):
            # A column for each number of the code, and what is there without any.
            maker = torch.cat((layer.weight, layer.bias[:, None]), 1).detach().contiguous()
            lend("makers", maker, outputs * inputs, CODE + 1)
            # Numbers stand in the order of `Query`: hidden layers in blocks of outputs, biases
            # first, padded with zeros; the last layer as it is.
            whole = maker.unflatten(0, (outputs, inputs))
            if outputs > 1:
                whole = pack(whole.roll(1, dims=1), BLOCK)
            rows.append(whole.reshape(-1, CODE + 1))
        numbers = torch.cat(rows).T.contiguous()
        self._makers = lend("makers", numbers[:-1], CODE, _NUMBERS)
        self._base = lend("base", numbers[-1], _NUMBERS)

    def __call__(self, codes: Tensor, eye: Tensor, axes: Tensor, points: Tensor) -> Tensor:
        """Return the clearance `[S, N]` at points `[3, S, N]` of the world frame, m.

        Images of `codes` `[64, S]` were taken from `eye` `[S, 3]` with the attitudes `axes`
        `[S, 3, 3]`.
        """
        _, scenes, count = points.shape
        clearance = output(scenes, count)
        self._kernels.call(
            "faultpath_clearance",
            *(self._bounds, self._makers, self._base),
            lend("codes", codes, CODE, scenes),
            lend("position", eye, scenes, 3),
            lend("rotation", axes, scenes, 3, 3),
            lend("points", points, 3, scenes, count),
            *(scenes, count, clearance),
        )
        return clearance.tensor


_SOLID = 12
"""Numbers of a `Solid` in `render_view.hpp`."""


class _Camera(Block):
    """`Camera` of `render_view.hpp`; the kernel takes up to 64 columns, in whole vectors."""

    _fields_ = (
        *fields(ctypes.c_int64, "height width"),
        *fields(ctypes.c_void_p, "left up planes"),
        ("range", ctypes.c_float),
    )


class CompiledRenderer:
    """Draws the depth images of a block of scenes."""

    def __init__(self, kernels: Kernels, solids: Tensor, planes: Tensor) -> None:
        """Prepare the solids of B scenes, K prisms each, the arena first.

        `solids` `[12, K, B]` are cosine and sine of the yaw, the centre along the prism's axes,
        half extents, rounding, sign, and from which to which height above its centre a prism can be
        seen; `planes` `[6, 4]` inward normals of the view and their offsets; m, float64.
        """
        self._kernels = kernels
        _, count, scenes = solids.shape
        laid = solids.permute(2, 1, 0)
        self._solids = lend("solids", laid, scenes, count, _SOLID, dtype=torch.float64)
        left, up = (slope.float() for slope in slopes())
        self._camera = _Camera(
            *(HEIGHT, WIDTH),
            lend("left", left, WIDTH),
            lend("up", up, HEIGHT),
            lend("planes", planes, 6, 4, dtype=torch.float64),
            RANGE_M,
        )

    def render(self, position: Tensor, rotation: Tensor) -> Tensor:
        """Return `[B, 36, 64]` as cameras at `[3, B]` of attitudes `[3, 3, B]` see it, float64."""
        scenes, count, _ = self._solids.tensor.shape
        images = output(scenes, HEIGHT, WIDTH)
        at, turned = position.expand(3, scenes), rotation.expand(3, 3, scenes)
        self._kernels.call(
            "faultpath_render",
            *(self._camera, self._solids, count, scenes),
            lend("position", at, 3, scenes, dtype=torch.float64),
            lend("rotation", turned, 3, 3, scenes, dtype=torch.float64),
            *(scenes, images),
        )
        return images.tensor
