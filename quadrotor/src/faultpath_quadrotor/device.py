"""Where the tensors of a flight live, and when the host may look at them."""

import warnings
from collections.abc import Generator
from contextlib import contextmanager
from functools import cache
from typing import Any

import torch
from torch import Tensor

from faultpath.plugin.system import Notice, UserError, one_thread
from faultpath_quadrotor.choices import DeviceName
from faultpath_quadrotor.instructions import level

CPU = torch.device("cpu")

HOST_READABLE = frozenset({"cpu"})
"""Types of device whose values the host reads without waiting for queued work."""


def device_of(name: DeviceName) -> torch.device:
    """Return a device by name; of several GPUs the first that is visible."""
    return CPU if name is DeviceName.CPU else torch.device("cuda", 0)


def host_readable(device: torch.device) -> bool:
    """Return whether the host may look at values on `device` during a control step.

    Code that differs between the CPU and an accelerator asks this and nothing else.
    """
    return device.type in HOST_READABLE


def send(host: Tensor, device: torch.device) -> Tensor:
    """Return a tensor of the host on `device`; the copy is queued and nobody waits for it.

    Only a copy from pinned memory can be: from any other the host waits for its turn.
    """
    if device.type == "cpu":
        return host
    return host.pin_memory().to(device, non_blocking=True)


@contextmanager
def arithmetic() -> Generator[None]:
    """Compute as flights do, and leave the process as it was.

    On one thread, as any worker does; on a GPU in full single precision, as everywhere, and
    repeatable.
    """
    _tell_of_other_instructions()
    cudnn: Any = torch.backends.cudnn
    flags = (cudnn.allow_tf32, cudnn.deterministic) if cudnn.is_available() else None
    if flags is not None:
        cudnn.allow_tf32, cudnn.deterministic = False, True
    try:
        with one_thread():
            yield
    finally:
        if flags is not None:
            cudnn.allow_tf32, cudnn.deterministic = flags


@cache
def _tell_of_other_instructions() -> None:
    """Say, once a process, that torch had its instructions before this package could set them."""
    here = torch.backends.cpu.get_cpu_capability()
    if level() and here != "AVX2":
        warnings.warn(
            f"torch computes with {here} in this process, because it was used before the quadrotor "
            "was imported, so trials may differ in their last bits from those of other processes: "
            "import faultpath_quadrotor first, or let worker processes run the trials.",
            Notice,
            stacklevel=2,
        )


def require(name: DeviceName) -> None:
    """Raise `UserError` where there is no such device."""
    if name is DeviceName.CUDA and not torch.cuda.is_available():
        raise UserError(
            f"device 'cuda' needs a GPU, and torch {torch.__version__} finds none here: leave "
            "--device out, or install a build of torch with CUDA on a machine that has one."
        )


def describe(name: DeviceName) -> str:
    """Return in words what computes on a device other than the CPU."""
    return f"{name} ({torch.cuda.get_device_name()}), portable path"
