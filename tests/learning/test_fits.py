"""What a fit sees, what it leaves behind, and what does not change it."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from repair_toys import SEEN, SHORT, Net, Spy, windows

from faultpath.core.errors import UserError
from faultpath.faults import Drift, Fault, resolve
from faultpath.learning import (
    Schedule,
    errors,
    evaluate,
    fit,
    load,
    reconstruction,
    uncertainty_training,
    withholding,
)
from faultpath.learning.model_card import weights_sha256
from faultpath.learning.windows import delivered

WILD = Schedule(learning_rate=1e30, optimiser="adam")
NO_ERROR = "gain:bias=0"
BY_STEP = uncertainty_training(errors({"gain": 0.2}, "step", 0.0))


def test_a_seed_decides_the_bits_an_error_of_size_zero_changes_none_and_torch_is_left_alone():
    before = torch.random.get_rng_state()
    repairs = (BY_STEP, 0), (BY_STEP, 0), (BY_STEP, 1), ((), 0), (uncertainty_training(NO_ERROR), 0)
    fits = [fit(Net, windows(), repair=repair, schedule=SHORT, seed=s) for repair, s in repairs]
    assert torch.equal(torch.random.get_rng_state(), before)
    one, same, other, plain, zero = (fitted.record.weights_sha256 for fitted in fits)
    assert one == same
    assert plain == zero
    assert len({one, other, plain}) == 3


def test_dropout_draws_alike_in_baseline_and_repair() -> None:
    class Dropping(Net):
        def __init__(self, masks):
            super().__init__()
            self.masks = masks

        def forward(self, inputs):
            kept = torch.nn.functional.dropout(torch.ones(3), training=self.training)
            self.masks.append(kept.tolist())
            return super().forward(inputs)

    plain, repaired = [], []
    fit(lambda: Dropping(plain), windows(), schedule=SHORT)
    fit(lambda: Dropping(repaired), windows(), repair=BY_STEP, schedule=SHORT)
    assert plain == repaired


def test_training_sees_what_the_taps_deliver_and_targets_pass_none() -> None:
    SEEN.clear()
    targets = []
    data = windows(40)

    def loss(output, target):
        if torch.is_grad_enabled():
            targets.append(target)
        return ((output - target) ** 2).mean()

    drift = Fault(channel="velocity", intervention=Drift(rate_per_s=2.0, walk_per_sqrt_s=1.0))
    fitted = fit(Spy, data, loss, repair=uncertainty_training(drift), schedule=SHORT, validation=0)
    faults = resolve((drift,), data.interface, data.readers)
    fitted_on = [target.tolist() for target in targets]
    minibatches = iter(zip(SEEN, fitted_on, strict=True))
    for epoch in range(SHORT.epochs):
        for _ in range(0, len(data), SHORT.batch_size):
            inputs, target = next(minibatches)
            rows = [data.targets.tolist().index(value) for value in target]
            readings = {name: value[rows] for name, value in data.readings.items()}
            expected, _ = delivered(data, faults, readings, rows, 0, epoch)
            for port, value in expected.items():
                assert np.array_equal(inputs[port].numpy(), value)
    assert next(minibatches, None) is None
    counts = {count.reader: count for count in fitted.record.taps}
    assert counts["observer.difference"].deliveries == 2 * 40 * 4
    assert counts["observer.difference"].altered_steps == 2 * 40 * 3  # a drift begins at zero
    assert counts["observer.model"].altered_steps == 0


def test_withholding_puts_the_neutral_value_in_every_window_and_keeps_it() -> None:
    SEEN.clear()
    data = windows()
    fitted = fit(Spy, data, repair=withholding("gain"), schedule=SHORT)
    assert {float(value) for seen in SEEN for value in seen["gain", "model"].unique()} == {1.0}
    gain = 2 * np.asarray(data.readings["gain"])
    doubled = replace(data, readings={**data.readings, "gain": gain})
    net = fit(Net, data, repair=withholding("gain"), schedule=SHORT)
    correct = [curve["correct"] for curve in net.record.validation]
    assert correct == [curve["perturbed"] for curve in net.record.validation]
    assert evaluate(net, doubled) == evaluate(net, data)
    assert evaluate(net, data, faults=("gain:scale=2",)) == evaluate(net, data)
    assert fitted.record.repair == "withholding: gain erased to 1 at observer.model, observer.scale"


def test_a_reconstruction_learns_the_correct_reading_from_what_its_module_reads() -> None:
    plain = windows(200)
    slope = np.asarray(plain.targets)
    data = replace(plain, targets=None, readings={**plain.readings, "slope": slope})
    schedule = Schedule(epochs=30, batch_size=16, learning_rate=0.01)
    repairs = (reconstruction("slope"), uncertainty_training("gain:uniform_scale=0.2"))
    fitted = fit(Net, data, repair=repairs, schedule=schedule)
    plainly = fit(Net, plain, repair=repairs[1], schedule=schedule)
    assert fitted.record.weights_sha256 == plainly.record.weights_sha256
    assert evaluate(fitted, data) < 0.1 * np.var(slope)


def test_readings_that_cannot_be_written_to_are_fitted_without_a_warning() -> None:
    data = windows()
    for values in (*data.readings.values(), data.targets):
        values.flags.writeable = False
    one, other = (fit(Net, given, schedule=SHORT).record for given in (data, windows()))
    assert one.weights_sha256 == other.weights_sha256


def test_an_episode_is_on_one_side_of_the_split() -> None:
    names = [f"episode/{i // 4}" for i in range(60)]
    training, held_out = windows(episodes=names).split(0.3)
    sides = {names[i] for i in training}, {names[i] for i in held_out}
    assert not sides[0] & sides[1]
    assert all(sides)
    few = windows(20, episodes=names[:20]).split(0.3)[1]
    assert {names[i] for i in few} == {name for name in sides[1] if name in names[:20]}


def test_files_are_safe_whole_and_give_the_module_back(tmp_path) -> None:
    fitted = fit(Net, windows(), repair=BY_STEP, schedule=SHORT, folder=tmp_path, name="observer")
    assert {p.name for p in tmp_path.iterdir()} == {"observer-0.json", "observer-0.safetensors"}
    again = load(Net(), fitted.path)
    assert again.record == fitted.record
    assert evaluate(again, windows()) == evaluate(fitted, windows())
    assert not again.module.training
    with pytest.raises(UserError, match="another architecture"):
        load(Net(width=9), fitted.path)
    conv = torch.nn.Conv2d(2, 3, 3).to(memory_format=torch.channels_last)
    assert weights_sha256(conv) == weights_sha256(conv.to(memory_format=torch.contiguous_format))


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (lambda p: p.write_bytes(p.read_bytes()[:-1] + b"x"), "not those of its card"),
        (lambda p: p.with_suffix(".json").write_text("{}"), "no card of a fit"),
        (lambda p: p.with_suffix(".json").unlink(), "No such file"),
        (lambda p: p.unlink(), "No such file"),
    ],
)
def test_damaged_files_are_refused(tmp_path, damage, said) -> None:
    fitted = fit(Net, windows(), schedule=SHORT, folder=tmp_path)
    damage(fitted.path)
    with pytest.raises(UserError, match=said):
        load(Net(), fitted.path)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: fit(Net, windows(), seed=-1), "negative"),
        (lambda: fit(Net, replace(windows(), targets=None)), "no targets"),
        (lambda: fit(lambda: 3, windows()), "no torch module"),
        (lambda: fit(torch.nn.Identity, windows()), "no parameters"),
        (lambda: fit(Net, windows(), validation=1.0), "no window is left"),
        (lambda: fit(Net, windows(), validation=10), "validation=10 is no share"),
        (lambda: windows(0), "there are none"),
        (lambda: windows(readings={"gain": 1.0}), "has 60 rows for 1 windows"),
        (
            lambda: fit(Net, windows(), repair=uncertainty_training("gain:scale=0.8,onset=4")),
            "from step 4' begins after their last step, and no window would have it: .* 4 steps",
        ),
        (lambda: fit(Net, windows(), lambda out, target: out - target), "one number"),
        (lambda: fit(Net, windows(targets=np.zeros((60, 1)))), "correct one of the two"),
        (lambda: fit(Net, windows(), repair=reconstruction("gain")), "leave that place out"),
        (lambda: fit(Net, windows(), repair=reconstruction("slope")), "no readings of 'slope'"),
        (lambda: fit(Net, windows(), repair=reconstruction("wind")), "unknown channel 'wind'"),
        (lambda: fit(Net, windows(), schedule=WILD), "left the finite numbers"),
    ],
)
def test_bad_input_is_one_sentence(wrong, said) -> None:
    with pytest.raises(UserError, match=said) as caught:
        wrong()
    assert "\n" not in str(caught.value)
