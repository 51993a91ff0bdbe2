"""What a kernel is lent: memory of the right form, layers of the right size, and nothing else."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import pytest
import torch
from test_native_planner import scored
from test_native_rollout import commands_of, inputs_of, predictor
from torch import Tensor

from faultpath.quadrotor import native
from faultpath.quadrotor.native.lending import lend
from faultpath.quadrotor.perception import compiled as seeing
from faultpath.quadrotor.perception.compiled import CompiledClearance, CompiledEncoder
from faultpath.quadrotor.planners import compiled as planning
from faultpath.quadrotor.predictors.horizon import HorizonLoop, Kind, Step
from faultpath.quadrotor.predictors.network import GatedCell
from faultpath.quadrotor.predictors.recurrent import recur
from faultpath.quadrotor.predictors.rollout import Rollout, rolling

pytestmark = pytest.mark.skipif(not native.available(), reason="nothing was compiled")


WRONG: dict[str, tuple[Tensor, str]] = {
    "shape": (torch.zeros(3, 5), r"shape \[3, 5\], not \[3, 4\]"),
    "rank": (torch.zeros(12), r"shape \[12\]"),
    "dtype": (torch.zeros(3, 4, dtype=torch.float64), "float64, not float32"),
    "half": (torch.zeros(3, 4, dtype=torch.float16), "float16"),
    "device": (torch.zeros(3, 4, device="meta"), "on meta, not on the CPU"),
    "layout": (torch.zeros(4, 3).T, "not contiguous"),
    "expanded": (torch.zeros(1, 4).expand(3, 4), "not contiguous"),
    "gradient": (torch.zeros(3, 4, requires_grad=True), "gradient"),
}


@pytest.mark.parametrize(("tensor", "says"), WRONG.values(), ids=WRONG)
def test_memory_that_a_kernel_would_misread_is_refused(tensor: Tensor, says: str) -> None:
    with pytest.raises(ValueError, match=rf"kernel: 'commands' .*{says}.*FAULTPATH_KERNELS"):
        lend("commands", tensor, 3, 4)


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
    refused: list[tuple[Callable[[], Rollout], str]] = [
        (partial(roll, given, commands.double()), "'commands' is float64"),
        (partial(roll, given, commands[:, :3]), r"'commands' has the shape"),
        (partial(roll, given, commands[:0]), "horizon of 0"),
        (partial(roll, given, commands[:, :, :2]), "'position' has the shape"),
    ]
    for call, says in refused:
        with pytest.raises(ValueError, match=says):
            call()


def layers_of(hidden: int = 8) -> dict[str, Tensor]:
    inputs = {"embed": 4, "gates": 48, "candidate": 16, "remembered": 32, "first": 51}
    outputs = {"embed": 16, "gates": 64, "candidate": 32, "remembered": 32, "first": hidden}
    inputs |= {"second": hidden, "last": hidden}
    outputs |= {"second": hidden, "last": 6}
    return {name: torch.zeros(outputs[name], 1 + inputs[name]) for name in inputs}


@pytest.mark.parametrize("name", list(layers_of()))
def test_a_layer_of_another_size_never_reaches_the_kernel(name: str) -> None:
    kernels, step = native.load(native.available()[0]), Step(Kind.ANCHORED, gravity=9.81)
    good = layers_of()
    HorizonLoop(kernels, step, good)
    wrong = {**good, name: torch.zeros(good[name].shape[0], good[name].shape[1] + 1)}
    with pytest.raises(ValueError, match="size of its layer"):
        HorizonLoop(kernels, step, wrong)


def test_perception_kernels_check_their_weights() -> None:
    kernels = native.load(native.available()[0])
    weights = [torch.zeros(shape) for shape in seeing.ENCODER_SHAPES]
    biases = [torch.zeros(shape[0]) for shape in seeing.ENCODER_SHAPES]
    CompiledEncoder(kernels, weights, biases, (6.0, 0.2, 0.4))
    for i in range(len(weights)):
        wrong = [*weights[:i], torch.zeros(3, 3), *weights[i + 1 :]]
        with pytest.raises(ValueError, match=f"weights of layer {i}"):
            CompiledEncoder(kernels, wrong, biases, (6.0, 0.2, 0.4))
        wrong = [*biases[:i], torch.zeros(3), *biases[i + 1 :]]
        with pytest.raises(ValueError, match=f"biases of layer {i}"):
            CompiledEncoder(kernels, weights, wrong, (6.0, 0.2, 0.4))
    makers = [torch.zeros(rows * columns, 65) for rows, columns in seeing.QUERY_SHAPES]
    bounds = seeing.Bounds(-0.3, 1.0, 0.25, 0.4, 1.0, 0.5)
    CompiledClearance(kernels, makers, bounds)
    with pytest.raises(ValueError, match="makers"):
        CompiledClearance(kernels, [makers[0], makers[0], makers[2]], bounds)


def test_a_cost_without_one_of_its_terms_is_refused() -> None:
    case = scored(torch.Generator().manual_seed(0), 16)
    paths = planning.Paths(
        case.rollout.positions,
        case.rollout.velocities,
        case.rollout.final.rotation,
        case.commands,
        case.clearance,
        case.goal,
        case.hover,
    )
    terms = dict.fromkeys(planning.TERMS, 1.0)
    del terms["hit"]
    with pytest.raises(ValueError, match="it takes running, goal, risk, hit"):
        planning.cost(native.load(native.available()[0]), terms, paths)


@torch.inference_mode()
def test_a_rollout_that_is_told_less_than_it_reads_is_refused() -> None:
    roll = rolling(predictor("wm-a-wind"))
    for field in ("dynamics", "wind_mps", "thrust_mass_kg", "code"):
        with pytest.raises(ValueError, match="was told none"):
            roll(replace(inputs_of(), **{field: None}), commands_of())


@torch.inference_mode()
def test_the_recurrent_kernel_checks_its_weights() -> None:
    kernels = native.load(native.available()[0])
    good, kept = GatedCell(19, 32), (torch.zeros(96, 32), torch.zeros(96, 1))
    given = (good.from_input.weight, good.from_input.bias)
    sequence = torch.ones(4, 19, 5)
    assert recur(kernels, given, kept, sequence).shape == (32, 5)
    for wrong, says in (
        ((given, kept, torch.ones(4, 20, 5)), "weights of the inputs"),
        ((given, kept, sequence.double()), "'sequence' is float64"),
        ((given, (torch.zeros(96, 33), kept[1]), sequence), "weights of the latent"),
        ((given, kept, torch.ones(4, 4096, 5)), "1 to 32 inputs, not 4096"),
    ):
        with pytest.raises(ValueError, match=says):
            recur(kernels, *wrong)
