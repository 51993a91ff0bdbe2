"""Every single difference between two fits is found, and nothing else is named."""

import numpy as np
import pytest
import torch
from repair_toys import SHORT, Net, scaled_net, windows
from torch import nn

from faultpath.learning import Schedule, fit, matched, uncertainty_training, withholding

REPAIR = uncertainty_training("gain:uniform_scale=0.2")


def weighed(factor):
    def loss(output, target):
        return factor * ((output - target) ** 2).mean()

    return loss


def absolute(output, target):
    return (output - target).abs().mean()


START = Net()
with torch.no_grad():
    OTHER = Net()
    OTHER.load_state_dict(START.state_dict())
    OTHER.last.bias += 0.1
TANH = Net(activation=nn.Tanh)
TANH.load_state_dict(START.state_dict())


def made(**changes):
    given = {"module": START, "data": windows(), "loss": weighed(1.0), "schedule": SHORT}
    return fit(**(given | changes))


def other(name, change):
    values = {key: np.asarray(value) for key, value in windows().readings.items()}
    return values | {name: change(values[name])}


DIFFERENCES = {
    "width": ({"module": Net(width=9)}, "Architecture: 'first.weight' is float32 [8, 8]"),
    "activation": ({"module": TANH}, "Architecture: (activation): ReLU()"),
    "readings": (
        {"data": windows(readings=other("gain", lambda v: v + 1e-3))},
        "Data: the readings of gain differ.",
    ),
    "targets": (
        {"data": windows(targets=-np.asarray(windows().targets))},
        "Data: the targets of target differ.",
    ),
    "windows": ({"data": windows(59)}, "Data: other windows, 60 in the baseline and 59"),
    "step": ({"data": windows(dt_s=0.2)}, "Data: steps of 0.1 s in the baseline and 0.2 s"),
    "split": ({"validation": 0.4}, "Split: other windows are trained on, 5"),
    "loss": ({"loss": absolute}, "Loss: weighed.loss in the baseline and absolute in the repair."),
    "constant of the loss": ({"loss": weighed(2.0)}, "Computation: before any step the same"),
    "initial weights": ({"module": OTHER}, "Initialisation: the weights before the first step"),
    "order": ({"seed": 1}, "Minibatch order: different from epoch 1 on"),
    "places": (
        {"data": windows(reader=("observer.model", "observer.difference"))},
        "Inputs: gain -> observer.model",
    ),
    "epochs": ({"schedule": Schedule(epochs=3, batch_size=16)}, "Budget: epochs 2 in the baseline"),
    **{
        name: (
            {"schedule": SHORT.model_copy(update={name: value})},
            f"Budget: {name.replace('_', ' ')} ",
        )
        for name, value in {
            "batch_size": 17,
            "learning_rate": 2e-3,
            "optimiser": "adam",
            "weight_decay": 0.0,
            "clip_norm": 1.0,
        }.items()
    },
}


@pytest.fixture(scope="module")
def baseline():
    return made()


@pytest.mark.parametrize("name", DIFFERENCES)
def test_a_single_difference_is_the_only_sentence(baseline, name) -> None:
    change, sentence = DIFFERENCES[name]
    found = matched(baseline, made(repair=REPAIR, **change))
    (said,) = found.differences
    assert said.startswith(sentence)
    assert said.endswith(".")
    assert not found.matched


def test_code_that_captures_another_number_shows_in_the_first_loss() -> None:
    torch.manual_seed(0)
    one, two, same = (scaled_net(factor)() for factor in (1.0, 2.0, 1.0))
    two.load_state_dict(one.state_dict())
    same.load_state_dict(one.state_dict())
    assert matched(made(module=one), made(module=same, repair=REPAIR)).matched
    (said,) = matched(made(module=one), made(module=two, repair=REPAIR)).differences
    assert said.startswith("Computation: before any step")


def test_another_machine_is_named(baseline) -> None:
    record = baseline.record
    machine = record.machine.model_copy(update={"python": "3.12"})
    (said,) = matched(baseline, record.model_copy(update={"machine": machine})).differences
    assert said.startswith("Machine: python")


@pytest.mark.parametrize("repair", [REPAIR, withholding("gain")], ids=lambda each: each.kind)
def test_fits_that_differ_in_the_repair_alone_are_matched(baseline, repair, tmp_path) -> None:
    repaired = made(repair=repair, folder=tmp_path)
    found = matched(baseline, repaired)
    assert found.matched
    assert str(found).startswith(f"matched in all but the repair ({repair.kind.replace('_', ' ')}:")
    assert matched(baseline.record, repaired.path) == found


def test_all_differences_are_listed(baseline) -> None:
    changed = made(loss=absolute, schedule=Schedule(epochs=1, batch_size=16), seed=2, repair=REPAIR)
    said = str(matched(baseline, changed)).splitlines()
    assert said[0] == "not matched:"
    names = [line.split(":")[0] for line in said[1:]]
    assert names == ["  - Loss", "  - Budget", "  - Minibatch order"]
