"""What a kernel is lent: memory of the right form, layers of the right size, and nothing else."""

import pytest
import torch
from faultpath_quadrotor import native
from faultpath_quadrotor.native.kernel_args import lend
from faultpath_quadrotor.predictors import PredictorInputs
from faultpath_quadrotor.predictors.rollout import rolling
from test_native_rollout import commands_of, inputs_of, predictor
from torch import Tensor

pytestmark = pytest.mark.skipif(not native.available(), reason="nothing was compiled")


WRONG: dict[str, tuple[Tensor, str]] = {
    "shape": (torch.zeros(3, 5), r"shape \[3, 5\], not \[3, 4\]"),
    "dtype": (torch.zeros(3, 4, dtype=torch.float64), "float64, not float32"),
    "device": (torch.zeros(3, 4, device="meta"), "on meta, not on the CPU"),
    "layout": (torch.zeros(3, 4).to_sparse(), "not dense"),
    "gradient": (torch.zeros(3, 4, requires_grad=True), "gradient"),
}


@pytest.mark.parametrize(("tensor", "says"), WRONG.values(), ids=WRONG)
def test_memory_that_a_kernel_would_misread_is_refused(tensor: Tensor, says: str) -> None:
    with pytest.raises(ValueError, match=rf"kernel: 'commands' .*{says}.*FAULTPATH_KERNELS"):
        lend("commands", tensor, 3, 4)


@pytest.mark.parametrize("tensor", [torch.rand(4, 3).T, torch.rand(1, 4).expand(3, 4)])
def test_a_kernel_is_lent_numbers_that_lie_in_a_row(tensor: Tensor) -> None:
    lent = lend("commands", tensor, 3, 4).tensor
    assert lent.is_contiguous()
    assert torch.equal(lent, tensor)


def test_a_tensor_that_nobody_checked_never_reaches_a_kernel() -> None:
    with pytest.raises(TypeError, match="not lent"):
        native.load(native.available()[0]).call("faultpath_cost", torch.zeros(3))


@torch.inference_mode()
@pytest.mark.parametrize("name", ["dki", "wm-a-wind", "wm-u"])
def test_a_rollout_checks_all_that_it_is_given(name: str) -> None:
    roll = rolling(predictor(name))
    given, commands = inputs_of(), commands_of()
    swapped = commands.movedim(3, 2).contiguous().movedim(2, 3)
    assert not swapped.is_contiguous()
    assert torch.equal(roll(given, swapped).positions, roll(given, commands).positions)
    refused = {
        "'commands' is float64": commands.double(),
        "'commands' has the shape": commands[:, :3],
        "horizon of 0": commands[:0],
        "'position' has the shape": commands[:, :, :2],
    }
    for says, wrong in refused.items():
        with pytest.raises(ValueError, match=says):
            roll(given, wrong)


@torch.inference_mode()
def test_a_rollout_that_is_told_less_than_it_reads_is_refused() -> None:
    roll = rolling(predictor("wm-a-wind"))
    given = inputs_of()
    for place in ("dynamics", "wind_map", "normalise_thrust", "latent"):
        less = {read: value for read, value in given.delivered.items() if read[1] != place}
        with pytest.raises(ValueError, match=rf"'{place}' and was told none"):
            roll(PredictorInputs(given.state, less), commands_of())
