"""Repaired modules in a loop get what they got in their fit."""

from collections.abc import Mapping

import numpy as np
import pytest
import torch
from plain import composed
from repair_toys import INTERFACE, SHORT, Net, windows

from faultpath.core.errors import UserError
from faultpath.faults import Fault, Scale, resolve
from faultpath.learning import Learned, errors, fit, uncertainty_training, withheld, withholding
from faultpath.loop import Batch, Inputs, Module, Port, Reading, Taps
from faultpath.run.attempt import taps_of
from faultpath.run.plan import Treatment
from faultpath.system import ComposedSystem, Parts

GAIN, VELOCITY = Port("gain", "model"), Port("velocity", "difference")


class Brake(Module):
    """Pushes against what it reads, and keeps what it got."""

    name, writes = "brake", ("push",)
    reads = frozenset({Port("place", "feedback"), Port("gain", "model"), Port("bias", "trim")})

    def __init__(self) -> None:
        self.got: list[Mapping[Port, np.ndarray]] = []

    def step(self, inputs: Inputs, memory: None):
        self.got.append({port: inputs[port] for port in inputs})
        wanted = -0.5 * inputs["place", "feedback"] - inputs["bias", "trim"]
        return {"push": wanted / inputs["gain", "model"]}, memory


def system(*variants: Module) -> ComposedSystem:
    return composed(
        {f"variant_{i}": Parts("One of them.", [m]) for i, m in enumerate(variants)},
        dict.fromkeys(("place", "gain", "bias", "push"), "1"),
        lambda rng: {"place": rng.uniform(1, 2), "gain": rng.uniform(0.5, 1.5), "bias": 0.0},
        lambda state, push, rng: state | {"place": state["place"] + state["gain"] * push},
        steps=5,
    )


def fly(made: ComposedSystem, variant: str, *faults: Fault, scenes=("seed/1", "seed/2")):
    resolved = resolve(faults, made.interface, made.variants[variant].readers)
    taps = taps_of(made, Treatment(variant=variant, faults=resolved), scenes)
    return made.run(variant, scenes, taps, 0)


def test_a_withheld_channel_is_not_read_and_its_neutral_value_arrives() -> None:
    inner, repair = Brake(), withholding("gain", value=1.25)
    deployed = system(Brake(), withheld(inner, repair, system(Brake()).interface))
    reading, blind = (deployed.variants[f"variant_{i}"].readers for i in (0, 1))
    assert reading - blind == {"brake.model"}
    inner.got.clear()
    fly(deployed, "variant_1")
    assert {float(value) for got in inner.got for value in got[Port("gain", "model")]} == {1.25}
    assert all(got[Port("gain", "model")].shape == (2,) for got in inner.got)
    with pytest.raises(UserError, match="reaches no reader: here are"):
        fly(deployed, "variant_1", Fault(channel="gain", intervention=Scale(factor=2.0)))


def test_what_is_withheld_in_flight_is_what_was_in_the_fit() -> None:
    class Pilot(Module):
        name, writes = "pilot", ("course",)
        reads = frozenset({Port("heading", "course"), Port("velocity", "feedback")})

        def step(self, inputs, memory):
            return {"course": inputs["heading", "course"]}, memory

    repair = withholding("heading", "pilot")
    made = withheld(Pilot(), repair, INTERFACE)
    (fault,) = repair.against(INTERFACE, 0.1, {"pilot.course"}).faults
    taps = Taps(INTERFACE, (fault,), scenes=("a", "b"), dt_s=0.1, readers={"pilot.course"})
    in_fit = taps.deliver("heading", "pilot.course", Reading(np.ones((2, 3)), "compass", 0), 0)
    inputs = Inputs("pilot", 0, {Port("velocity", "feedback"): torch.zeros(2)}, {})
    outputs, _ = made.step(inputs, made.begin(Batch(("a", "b"), 0, 0.1)))
    assert isinstance(outputs["course"], torch.Tensor)
    assert np.array_equal(outputs["course"].numpy(), in_fit)


def test_a_learned_module_gets_the_last_steps_as_in_its_windows() -> None:
    data = windows(12, 4)
    net = fit(Net, data, schedule=SHORT).module
    made = Learned("observer", net, "slope", [GAIN, VELOCITY], steps=4)
    memory = None
    for step in range(4):
        read = {GAIN: data.readings["gain"], VELOCITY: data.readings["velocity"][:, step]}
        delivered = {port: np.asarray(value, dtype=float) for port, value in read.items()}
        outputs, memory = made.step(Inputs("observer", step, delivered, {}), memory)
    gain = torch.from_numpy(np.repeat(np.asarray(data.readings["gain"])[:, None], 4, axis=1))
    velocity = torch.from_numpy(np.asarray(data.readings["velocity"]))
    with torch.no_grad():
        expected = net({GAIN: gain, VELOCITY: velocity}).numpy()
    assert outputs["slope"] == pytest.approx(expected, rel=1e-5)
    one = {port: value[3:4] for port, value in delivered.items()}
    inputs = [Inputs("observer", 0, some, {}) for some in (delivered, one)]
    first, alone = (made.step(given, None)[0] for given in inputs)
    assert first["slope"][3] == alone["slope"][0]  # to the bit, in other company


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (withholding("wind", value=0.0), "unknown channel 'wind'"),
        (withholding("gain", "pilot", 1.0), "reads nothing of"),
        (uncertainty_training(errors({"gain": 0.1})), "no withholding"),
    ],
)
def test_bad_input_is_one_sentence(wrong, said) -> None:
    with pytest.raises(UserError, match=said):
        withheld(Brake(), wrong, INTERFACE)
