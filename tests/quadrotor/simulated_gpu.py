"""A GPU of which only shapes and places are real, for machines that have none."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import torch
from torch import Tensor
from torch._subclasses.fake_tensor import FakeTensor, FakeTensorMode
from torch.utils._pytree import tree_leaves, tree_map

GPU = torch.device("lazy", 0)
"""Where its tensors are. A build of torch without CUDA cannot even take a row of a tensor on
`cuda`; of all accelerators that it knows, this is the one of which it can."""

_TO = torch.ops.aten._to_copy.default
_INTO = torch.ops.aten.copy_.default
_WAITING = ("_linalg_svd", "_linalg_eigh", "linalg_eig", "linalg_lstsq", "_linalg_check_errors")
"""Operations that look at their own result on a GPU, which a simulated one has not."""


class HostWaited(AssertionError):
    """The host would have waited for the GPU."""


class SimulatedGPU(FakeTensorMode):
    """Computes what is on the CPU, and of what is on the GPU knows only shape, type and place.

    A tensor of the CPU that meets one of the GPU is an error, as on a real one, unless it is a
    single number. Reading a value of a simulated tensor is an error too. While `watching`, so is
    every copy for which the host waits: one to the host, and one from memory that is not pinned.
    """

    watching = False
    operations = 0

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        if func is torch.ops.prim.device.default:
            return args[0].fake_device
        kwargs = kwargs or {}
        if func is torch.ops.aten.is_pinned.default:
            return False
        if func is torch.ops.aten._pin_memory.default:
            pinned = args[0].clone()
            pinned.pinned_here = True
            return pinned
        given = [leaf for leaf in tree_leaves((args, kwargs)) if isinstance(leaf, Tensor)]
        target = kwargs.get("device")
        there = target is not None and torch.device(target) == GPU
        if not there and not any(isinstance(tensor, FakeTensor) for tensor in given):
            return func(*args, **kwargs)
        self._check(func, given, there, kwargs)
        self.operations += 1
        args, kwargs = tree_map(self._simulated, (args, kwargs))
        return super().__torch_dispatch__(func, types, args, kwargs)

    def _check(self, func: Any, given: list[Tensor], there: bool, kwargs: Any) -> None:
        host = [t for t in given if not isinstance(t, FakeTensor) and t.ndim]
        if func not in (_TO, _INTO):
            assert not host, f"{func}: tensors of the CPU and the GPU together"
        if not self.watching:
            return
        if func._schema.name.removeprefix("aten::") in _WAITING:
            raise HostWaited(f"{func} waits for its own result")
        if func is _TO and kwargs.get("device") is not None and not there:
            raise HostWaited("a copy to the host waits for it")
        for tensor in host:
            queued = func is _TO and kwargs.get("non_blocking")
            if not queued or not getattr(tensor, "pinned_here", False):
                raise HostWaited("a copy from memory that is not pinned waits for its turn")

    def _simulated(self, value: Any) -> Any:
        if isinstance(value, Tensor) and not isinstance(value, FakeTensor):
            return self.from_tensor(value)
        return value


@contextmanager
def simulated_gpu() -> Iterator[SimulatedGPU]:
    """Let tensors on `GPU` be simulated."""
    with torch.no_grad(), SimulatedGPU() as gpu:
        yield gpu
