"""Every single difference between two fits is found, and nothing else is named."""

import numpy as np
import pytest
import torch
from repair_toys import SHORT, Net, windows
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


READINGS = windows().readings
OTHER_GAIN = windows(readings={**READINGS, "gain": np.asarray(READINGS["gain"]) + 1e-3})
OTHER_TARGETS = windows(targets=-np.asarray(windows().targets))
FEWER_PLACES = windows(reader=("observer.model", "observer.difference"))
DIFFERENCES = {
    "width": ({"module": Net(width=9)}, "Architecture: 'first.weight' is float32 [8, 8]"),
    "activation": ({"module": TANH}, "Architecture: (activation): ReLU()"),
    "readings": ({"data": OTHER_GAIN}, "Data: the readings of gain differ."),
    "targets": ({"data": OTHER_TARGETS}, "Data: the targets of target differ."),
    "windows": ({"data": windows(59)}, "Data: other windows, 60 in the baseline and 59"),
    "step": ({"data": windows(dt_s=0.2)}, "Data: steps of 0.1 s in the baseline and 0.2 s"),
    "split": ({"validation": 0.4}, "Split: other windows are trained on, 5"),
    "loss": ({"loss": absolute}, "Loss: weighed.loss in the baseline and absolute in the repair."),
    "constant of the loss": ({"loss": weighed(2.0)}, "Computation: before any step the same"),
    "initial weights": ({"module": OTHER}, "Initialisation: the weights before the first step"),
    "order": ({"seed": 1}, "Minibatch order: different from epoch 1 on"),
    "places": ({"data": FEWER_PLACES}, "Inputs: gain -> observer.model"),
    "epochs": ({"schedule": Schedule(epochs=3, batch_size=16)}, "Budget: epochs 2 in the baseline"),
}
BUDGETS = {
    "batch_size": 17,
    "learning_rate": 2e-3,
    "optimiser": "adam",
    "weight_decay": 0.0,
    "clip_norm": 1.0,
}
for name, value in BUDGETS.items():
    schedule = SHORT.model_copy(update={name: value})
    DIFFERENCES[name] = {"schedule": schedule}, f"Budget: {name.replace('_', ' ')} "


@pytest.fixture(scope="module")
def baseline():
    return made()


@pytest.mark.parametrize("name", DIFFERENCES)
def test_a_single_difference_is_the_only_sentence(baseline, name) -> None:
    change, sentence = DIFFERENCES[name]
    comparison = matched(baseline, made(repair=REPAIR, **change))
    (said,) = comparison.differences
    assert said.startswith(sentence)
    assert said.endswith(".")
    assert not comparison.matched


@pytest.mark.parametrize("repair", [REPAIR, withholding("gain")], ids=lambda repair: repair.kind)
def test_fits_that_differ_in_the_repair_alone_are_matched(baseline, repair, tmp_path) -> None:
    repaired = made(repair=repair, folder=tmp_path)
    comparison = matched(baseline, repaired)
    assert comparison.matched
    kind = repair.kind.replace("_", " ")
    assert str(comparison).startswith(f"matched in all but the repair ({kind}:")
    assert matched(baseline.record, repaired.path) == comparison
    machine = repaired.record.machine.model_copy(update={"python": "3.12"})
    elsewhere = repaired.record.model_copy(update={"machine": machine})
    (said,) = matched(baseline, elsewhere).differences
    assert said.startswith("Machine: python")


def test_all_differences_are_listed(baseline) -> None:
    changed = made(loss=absolute, schedule=Schedule(epochs=1, batch_size=16), seed=2, repair=REPAIR)
    said = str(matched(baseline, changed)).splitlines()
    assert said[0] == "not matched:"
    names = [line.split(":")[0] for line in said[1:]]
    assert names == ["  - Loss", "  - Budget", "  - Minibatch order"]
