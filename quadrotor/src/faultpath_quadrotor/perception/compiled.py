"""The encoder of depth images and the clearance queries of its codes, compiled."""

import ctypes
from collections.abc import Sequence
from typing import NamedTuple

import torch
from torch import Tensor

from faultpath_quadrotor.native.kernel_args import (
    BLOCK,
    Block,
    Lent,
    as_kernel_argument,
    fields,
    pack,
)
from faultpath_quadrotor.native.library import WIDEST, Kernels

HEIGHT, WIDTH, CODE = 36, 64, 64
ENCODER_SHAPES = ((16, 2, 5, 5), (32, 16, 3, 3), (48, 32, 3, 3), (128, 48 * 5 * 8), (CODE, 128))
"""Weights of three convolutions and two dense layers; fixed in `encoder.cpp`, as is `CODE`."""

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
    """Encodes depth images one by one, with a copy of the weights."""

    def __init__(
        self,
        kernels: Kernels,
        weights: Sequence[Tensor],
        biases: Sequence[Tensor],
        inputs: tuple[float, float, float],
    ) -> None:
        """Copy the weights.

        Args:
            kernels: What encodes.
            weights: Weights of the shapes in `ENCODER_SHAPES`.
            biases: One for each output of each layer.
            inputs: A range r, a nearest depth n and a scale s: an image of depths d enters as d / r
                and as s / max(d, n).
        """
        self._kernels = kernels
        for i, (shape, weight, bias) in enumerate(
            zip(ENCODER_SHAPES, weights, biases, strict=True)
        ):
            as_kernel_argument(f"weights of layer {i}", weight.detach().contiguous(), *shape)
            as_kernel_argument(f"biases of layer {i}", bias.detach().contiguous(), shape[0])
        *convolutions, dense, last = (weight.detach() for weight in weights)
        # The kernel's features have their channels last, the model's flattened ones first.
        turned = dense.unflatten(1, (ENCODER_SHAPES[2][0], -1)).transpose(1, 2).flatten(1)
        laid = [weight.permute(2, 3, 1, 0) for weight in convolutions]
        laid += [w.unflatten(0, (-1, _SUMMED)).transpose(1, 2) for w in (turned, last)]
        laid += [bias.detach() for bias in biases]
        copies = [Lent(part.clone(memory_format=torch.contiguous_format)) for part in laid]
        self._table = _Encoder(*copies, *inputs)

    def __call__(self, depth: Tensor) -> Tensor:
        """Return the codes `[64, S]` of images `[S, 36, 64]`, m."""
        codes = torch.empty(CODE, len(depth))
        self._kernels.call(
            "faultpath_encode",
            self._table,
            as_kernel_argument("depth", depth.float().contiguous(), len(depth), HEIGHT, WIDTH),
            len(depth),
            as_kernel_argument("codes", codes, CODE, len(depth)),
        )
        return codes


FEATURES, HIDDEN = 8, 47
"""Fixed in `clearance.cpp`, without the constants that carry the biases."""
QUERY_SHAPES = ((HIDDEN, FEATURES + 1), (HIDDEN, HIDDEN + 1), (1, HIDDEN + 1))
"""Outputs and inputs of the layers of a query network; the last input is the bias."""

_NUMBERS = (FEATURES + 1 + HIDDEN + 1 + 1) * (HIDDEN + 1)
"""Numbers of a query network (`Query` in `clearance.cpp`)."""


class ClearanceBounds(NamedTuple):
    """Bounds of the answer, and of the space that the image covers."""

    lowest_m: float
    highest_m: float
    unseen_m: float
    """Most clearance where no pixel looks."""
    near_m: float
    """Distance within which that does not matter."""
    left: float
    """Half the image's width, per metre forward."""
    up: float


class _Bounds(Block):
    """`Bounds` of `clearance.cpp`."""

    _fields_ = fields(ctypes.c_float, "lowest highest unseen near left up")


class CompiledClearance:
    """Capture frame, features, query network and field of view in one pass."""

    def __init__(self, kernels: Kernels, makers: Sequence[Tensor], bounds: ClearanceBounds) -> None:
        """Copy the maps that make a query network from a code.

        Args:
            kernels: What answers.
            makers: For each layer of `QUERY_SHAPES`, `[outputs * inputs, 64 + 1]`: a column for
                each number of the code, and what is there without any.
            bounds: What the answer keeps to.
        """
        self._kernels = kernels
        self._bounds = _Bounds(*bounds._replace(near_m=bounds.near_m**2))
        rows: list[Tensor] = []
        for maker, (outputs, inputs) in zip(makers, QUERY_SHAPES, strict=True):
            as_kernel_argument("makers", maker.detach().contiguous(), outputs * inputs, CODE + 1)
            # Numbers stand in the order of `Query`: hidden layers in blocks of outputs, biases
            # first, padded with zeros; the last layer as it is.
            whole = maker.detach().unflatten(0, (outputs, inputs))
            if outputs > 1:
                whole = pack(whole.roll(1, dims=1), BLOCK)
            rows.append(whole.reshape(-1, CODE + 1))
        numbers = torch.cat(rows).T.contiguous()
        self._makers = as_kernel_argument("makers", numbers[:-1].contiguous(), CODE, _NUMBERS)
        self._base = as_kernel_argument("base", numbers[-1].contiguous(), _NUMBERS)

    def __call__(self, codes: Tensor, eye: Tensor, axes: Tensor, points: Tensor) -> Tensor:
        """Return the clearance `[S, N]`, m.

        Args:
            codes: `[64, S]`.
            eye: Where the images were taken from, `[S, 3]`, m.
            axes: The camera's attitudes there, `[S, 3, 3]`.
            points: World frame, `[3, S, N]`, m.
        """
        _, scenes, count = points.shape
        clearance = points.new_empty(scenes, count)
        self._kernels.call(
            "faultpath_clearance",
            *(self._bounds, self._makers, self._base),
            as_kernel_argument("codes", codes.contiguous(), CODE, scenes),
            as_kernel_argument("position", eye.contiguous(), scenes, 3),
            as_kernel_argument("rotation", axes.contiguous(), scenes, 3, 3),
            as_kernel_argument("points", points.contiguous(), 3, scenes, count),
            *(scenes, count),
            as_kernel_argument("clearance", clearance, scenes, count),
        )
        return clearance


_SOLID = 12
"""Numbers of a `Solid` in `render_view.hpp`."""
_WIDEST_IMAGE = 64
"""Columns for which `render.cpp` has room."""


class _Camera(Block):
    """`Camera` of `render_view.hpp`."""

    _fields_ = (
        *fields(ctypes.c_int64, "height width"),
        *fields(ctypes.c_void_p, "left up planes"),
        ("range", ctypes.c_float),
    )


class CompiledRenderer:
    """Draws the depth images of a block of scenes."""

    def __init__(
        self,
        kernels: Kernels,
        solids: Tensor,
        slopes: tuple[Tensor, Tensor],
        planes: Tensor,
        range_m: float,
    ) -> None:
        """Prepare the solids of B scenes.

        Args:
            kernels: What draws.
            solids: K prisms a scene, the arena first, `[12, K, B]`: cosine and sine of the yaw, the
                centre along the prism's axes, half extents, rounding, sign, and from which to which
                height above its centre it can be seen; m, float64.
            slopes: How far the pixels' rays go left `[64]` and up `[36]` per metre forward.
            planes: Inward normals of the view and their offsets, `[6, 4]`.
            range_m: What a pixel reads that sees nothing.

        Raises:
            ValueError: The image is wider than the kernel's rows or not whole vectors wide, or
                there is no prism.
        """
        self._kernels = kernels
        _, count, scenes = solids.shape
        laid = solids.permute(2, 1, 0).contiguous()
        self._solids = as_kernel_argument(
            "solids", laid, scenes, count, _SOLID, dtype=torch.float64
        )
        left, up = (slope.float().contiguous() for slope in slopes)
        self._shape = (len(up), len(left))
        if not count or not len(up) or not 0 < len(left) <= _WIDEST_IMAGE or len(left) % WIDEST:
            raise ValueError(
                f"the camera's kernel draws images of {WIDEST} to {_WIDEST_IMAGE} columns, in "
                f"multiples of {WIDEST}, and an arena; it was given {len(left)} columns and "
                f"{count} prisms"
            )
        self._camera = _Camera(
            *self._shape,
            as_kernel_argument("left", left, len(left)),
            as_kernel_argument("up", up, len(up)),
            as_kernel_argument("planes", planes.double().contiguous(), 6, 4, dtype=torch.float64),
            range_m,
        )

    def render(self, position: Tensor, rotation: Tensor) -> Tensor:
        """Return `[B, 36, 64]` as cameras at `[3, B]` of attitudes `[3, 3, B]` see it, float64."""
        scenes, count, _ = self._solids.tensor.shape
        images = torch.empty(scenes, *self._shape)
        at = position.expand(3, scenes).contiguous()
        turned = rotation.expand(3, 3, scenes).contiguous()
        self._kernels.call(
            "faultpath_render",
            *(self._camera, self._solids, count, scenes),
            as_kernel_argument("position", at, 3, scenes, dtype=torch.float64),
            as_kernel_argument("rotation", turned, 3, 3, scenes, dtype=torch.float64),
            scenes,
            as_kernel_argument("images", images, scenes, *self._shape),
        )
        return images
