"""Compiled dense layers and angles are torch's to rounding, and a column depends on no other."""

import pytest
import torch
from faultpath_quadrotor import native
from faultpath_quadrotor.predictors.network import affine
from faultpath_quadrotor.so3 import sine_cosine


@torch.inference_mode()
@pytest.mark.parametrize("gelu", [False, True])
@pytest.mark.parametrize(("outputs", "inputs", "columns"), [(64, 52, 32), (3, 64, 5), (17, 1, 1)])
def test_a_layer_is_the_portable_one_and_its_columns_are_their_own(
    isa: str, outputs: int, inputs: int, columns: int, gelu: bool
) -> None:
    stream = torch.Generator().manual_seed(0)
    shapes = ((outputs, inputs), (outputs, 1), (inputs, columns))
    weight, bias, x = (torch.randn(*shape, generator=stream) for shape in shapes)
    with native.using(isa):
        compiled = affine(weight, bias, x, gelu)
        last = affine(weight, bias, x[:, -1:], gelu)
    with native.using(native.PORTABLE):
        portable = affine(weight, bias, x, gelu)
    torch.testing.assert_close(compiled, portable, rtol=1e-5, atol=1e-5)
    assert torch.equal(compiled[:, -1:], last)


@torch.inference_mode()
@pytest.mark.parametrize(("dtype", "error"), [(torch.float32, 1.2e-7), (torch.float64, 2.3e-16)])
def test_sine_and_cosine_are_exact_to_rounding(isa: str, dtype: torch.dtype, error: float) -> None:
    angles = torch.linspace(-300, 300, 10_001, dtype=dtype).view(73, 137)
    with native.using(isa):
        sine, cosine = sine_cosine(angles)
    exact = angles.double()
    assert (sine - exact.sin()).abs().max() < error
    assert (cosine - exact.cos()).abs().max() < error


def test_the_linear_unit_keeps_what_is_no_number_and_stays_finite_elsewhere(isa: str) -> None:
    one, zero = torch.ones(1, 1), torch.zeros(1, 1)
    x = torch.tensor([[torch.nan, -1e30, -50.0, 0.0, 50.0, 1e30]])
    with native.using(isa), torch.inference_mode():
        y = affine(one, zero, x, gelu=True)
    expected = torch.tensor([[torch.nan, 0.0, 0.0, 0.0, 50.0, 1e30]])
    torch.testing.assert_close(y, expected, equal_nan=True)
