"""A trial has the same bits on every processor with AVX2 and FMA, whatever its user has set.

`stages.json` holds the hash of every stage. Where they are to change, `python
tests/quadrotor/stages.py --keep` writes them anew, and every stored run has other bits then.
"""

import json
import math
import os
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
import torch
from faultpath_quadrotor import instructions, native
from faultpath_quadrotor.so3 import root
from kernel_sets import FUSED
from stages import KEPT, measured
from torch.utils._python_dispatch import TorchDispatchMode

pytestmark = pytest.mark.skipif(not FUSED, reason="without kernels a machine keeps its own bits")

SETTINGS = {
    "ATEN_CPU_CAPABILITY": "default",
    "MKL_CBWR": "AUTO",
    "OMP_NUM_THREADS": "2",
    "MKL_NUM_THREADS": "2",
    "OPENBLAS_NUM_THREADS": "2",
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX512DQ,-AVX512BW,-AVX512CD",
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
    "OPENBLAS_CORETYPE": "Nehalem",
    "MKL_ENABLE_INSTRUCTIONS": "SSE4_2",
}
"""Settings that a user may have made: plain and old code in the libraries, and two threads."""


APPROXIMATED = {"sqrt", "rsqrt", "acos", "asin", "erf", "erfc", "erfinv"}
"""Operations that torch leaves to a library, which may begin with the processor's approximation."""


class Called(TorchDispatchMode):
    """Names of the operations of torch that were called, without the mark of those in place."""

    def __init__(self) -> None:
        super().__init__()
        self.names = set[str]()

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        del types
        self.names.add(func.overloadpacket.__name__.rstrip("_"))
        return func(*args, **kwargs or {})


@pytest.fixture(scope="module")
def kept() -> dict[str, str]:
    return json.loads(KEPT.read_text())


def changed(kept: dict[str, str], now: dict[str, str]) -> list[str]:
    assert kept.keys() == now.keys()
    return [name for name in kept if kept[name] != now[name]]


@pytest.mark.parametrize("isa", FUSED)
def test_every_stage_has_the_bits_that_are_kept(isa: str, kept: dict[str, str]) -> None:
    """With the set that runs unless another is asked for, none takes an approximation either."""
    called = Called()
    usual = isa == FUSED[0]
    with native.using(isa), called if usual else nullcontext():
        assert changed(kept, measured()) == []
    assert not usual or {"add", "mul", "exp", "atan2"} <= called.names
    assert not called.names & APPROXIMATED


@pytest.mark.slow
def test_settings_of_a_user_change_no_bit(kept: dict[str, str]) -> None:
    unset = {*instructions.SETTINGS, "FAULTPATH_KERNELS"}
    variables = {key: value for key, value in os.environ.items() if key not in unset} | SETTINGS
    script = Path(__file__).with_name("stages.py")
    ended = subprocess.run(
        [sys.executable, script], env=variables, check=True, capture_output=True, text=True
    )
    assert changed(kept, json.loads(ended.stdout)) == []


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_roots_are_rounded_correctly_and_those_of_a_fit_have_a_gradient(dtype: torch.dtype) -> None:
    squares = torch.rand(4096, dtype=dtype, generator=torch.Generator().manual_seed(0))
    with torch.inference_mode():
        exact = [math.sqrt(square) for square in squares.tolist()]
        assert torch.equal(root(squares), torch.tensor(exact, dtype=torch.float64).to(dtype))
        assert root(squares.sum()).shape == ()
    assert root(squares.clone().requires_grad_()).requires_grad


def test_torch_computes_by_the_set_that_every_processor_has() -> None:
    assert torch.backends.cpu.get_cpu_capability() == "AVX2"


TORCH_FIRST = """
import torch, warnings
torch.ones(64).sum()
from faultpath_quadrotor.device import arithmetic
with warnings.catch_warnings(record=True) as shown:
    with arithmetic(), arithmetic():
        pass
print([str(notice.message) for notice in shown])
"""


def test_a_process_that_used_torch_before_is_told_once() -> None:
    variables = os.environ | {"ATEN_CPU_CAPABILITY": "default"}
    line = [sys.executable, "-c", TORCH_FIRST]
    ended = subprocess.run(line, env=variables, check=True, capture_output=True, text=True)
    assert ended.stdout.count("torch computes with ") == 1
    assert "import faultpath_quadrotor first" in ended.stdout
