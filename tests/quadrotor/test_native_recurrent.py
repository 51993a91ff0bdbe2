"""The compiled recurrent unit is the portable one to rounding."""

import pytest
import torch
from faultpath_quadrotor import native
from faultpath_quadrotor.predictors.network import GatedCell, draw_weights
from faultpath_quadrotor.predictors.recurrent import recur


def cell_and_sequence(inputs: int, columns: int) -> tuple[GatedCell, torch.Tensor]:
    stream = torch.Generator().manual_seed(inputs)
    cell = GatedCell(inputs, 32)
    draw_weights(cell, stream)
    return cell, 2 * torch.randn(12, inputs, columns, generator=stream)


@pytest.mark.parametrize("inputs", [19, 22, 32])
def test_the_last_latent_is_the_portable_one(isa: str, inputs: int) -> None:
    cell, sequence = cell_and_sequence(inputs, columns=5)
    with torch.enable_grad():  # the way by which training goes
        portable = cell.last(sequence).detach()
    assert portable.std() > 0.1
    given, kept = ((layer.weight, layer.bias) for layer in (cell.from_input, cell.from_latent))
    compiled = recur(native.load(isa), given, kept, sequence)
    torch.testing.assert_close(compiled, portable, rtol=1e-5, atol=1e-5)


def test_training_differentiates_through_the_unit() -> None:
    cell, sequence = cell_and_sequence(4, columns=3)
    cell.last(sequence).sum().backward()
    assert cell.from_latent.weight.grad is not None
    assert cell.from_latent.weight.grad.abs().sum() > 0
