"""A hash of each trial's trajectory: all values that its readers got while it ran."""

from hashlib import blake2b
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.core.arrays import Array, HostArray, copy, is_array, row_bytes, to_numpy

_LARGEST_BUFFER = 1 << 22
"""Bytes hashed together: one call a scene is far cheaper than one a delivery."""


class Trajectories:
    """The trajectories of the scenes of a block.

    The bits of the values count, in order of delivery; names do not, so renaming a channel leaves
    the hash as it is. A scene that has ended adds nothing, so that its hash does not depend on the
    others of its block.
    """

    def __init__(self, n_scenes: int) -> None:
        self._hashes = [blake2b(digest_size=8) for _ in range(n_scenes)]
        self._waiting: list[tuple[Array, Array]] = []
        """Values, and which scenes ran then: `[B, ...]` and bool `[B]`."""
        self._size = 0
        self._mask: Array = None
        self._mask_copy: Array = None

    def set_running(self, mask: Array | None) -> None:
        """Set which scenes run from now on, bool `[B]`; `None`: all."""
        self._mask, self._mask_copy = mask, None

    def note(self, value: Any, only: HostArray | None = None) -> None:
        """Add a value that a reader got in all scenes, or in `only` some, bool `[B]`.

        Values without a row a scene, such as the answers of a query, are left out: they show in
        what the reader does with them.
        """
        scenes = len(self._hashes)
        if not is_array(value) or value.shape[:1] != (scenes,) or 0 in value.shape:
            return
        if self._mask_copy is None and self._mask is not None:
            self._mask_copy = copy(self._mask)  # the plant may reuse its mask later
        # Without its autograd graph, which would keep all steps in memory.
        value = value.detach() if hasattr(value, "detach") else value
        mask = self._mask_copy
        if only is not None:
            mask = only if mask is None else only & to_numpy(mask)
        self._waiting.append((copy(value), mask))
        self._size += prod(value.shape) * 8
        if self._size > _LARGEST_BUFFER:
            self._flush()

    def hashes(self) -> tuple[str, ...]:
        """Return a hash a scene of the values so far; this waits for the device."""
        self._flush()
        return tuple(state.hexdigest() for state in self._hashes)

    def _flush(self) -> None:
        if not self._waiting:
            return
        scenes = len(self._hashes)
        masks, widths, parts = list[Array](), list[int](), list[NDArray[np.uint8]]()
        for value, mask in self._waiting:  # most values of a step share one mask
            parts.append(row_bytes(value))
            if not masks or mask is not masks[-1]:
                masks.append(mask)
                widths.append(0)
            widths[-1] += parts[-1].shape[1]
        running = np.ones((scenes, len(masks)), np.bool_)
        for step, mask in enumerate(masks):
            if mask is not None:
                running[:, step] = to_numpy(mask)
        values = np.concatenate(parts, axis=1)
        for state, row, steps in zip(self._hashes, values, running, strict=True):
            if steps.all():
                state.update(row)
            elif steps.any():
                state.update(row[np.repeat(steps, widths)])
        self._waiting, self._size = [], 0
