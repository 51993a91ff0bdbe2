"""What the numbers of a reading are called, by whom it is said, and where it comes out."""

import math
from pathlib import Path

import numpy as np
import pytest

from faultpath.errors import SystemMistake
from faultpath.quadrotor.evidence.components import COMPONENTS
from faultpath.quadrotor.interface import quadrotor_interface
from faultpath.report.viewer_signals import plots
from faultpath.review.components import components_of
from faultpath.store import TrialAddress
from faultpath.store.signals import Signal, decode_signals, encode_signals
from faultpath.trials import SystemSpec, load_system

ROOT = Path(__file__).parents[2]
AT = TrialAddress("mine", "shared", 0, "s0")


def test_every_short_vector_of_the_quadrotor_is_named() -> None:
    many = {each.name: math.prod(each.shape) for each in quadrotor_interface(True).sources}
    assert {name: len(COMPONENTS[name]) for name, n in many.items() if 1 < n < 9} == {
        name: n for name, n in many.items() if 1 < n < 9
    }


def test_an_example_names_its_components() -> None:
    system = load_system(SystemSpec(name=str(ROOT / "examples" / "pendulum.py:create")))
    assert components_of(system)["encoders"] == ("cart", "pole")


@pytest.mark.parametrize(
    ("named", "said"),
    [
        ({"gain_estimate": ("one", "two")}, "name the 1 of 'gain_estimate'"),
        ({"gain_estimate": "x"}, "name the 1 of 'gain_estimate'"),
        ({"gain_estimate": (7,)}, "name the 1 of 'gain_estimate'"),
        ({"nothing": ("x",)}, "no source 'nothing'"),
        (7, "no mapping"),
    ],
)
def test_names_that_do_not_fit_are_the_systems_mistake(named: object, said: str) -> None:
    system = load_system(SystemSpec(name=str(ROOT / "examples" / "toy.py:create")))
    assert components_of(system) == {}
    vars(system)["components"] = named
    with pytest.raises(SystemMistake, match=said):
        components_of(system)


def test_plots_are_called_by_the_components_with_their_own_units() -> None:
    values = np.arange(10, dtype=np.float32).reshape(5, 2)
    seen = Signal("encoders", "pole_angle", "m, rad", values, ("cart", "pole"))
    other = Signal("speed", "speed", "m/s", values)
    held = decode_signals(encode_signals({AT: (seen, other)}))
    assert [each.parts for each in held[AT]] == [("cart", "pole"), ()]
    called = [("pole angle, cart", "m"), ("pole angle, pole", "rad")]
    called += [("speed, 1", "m/s"), ("speed, 2", "m/s")]
    assert [(plot.title, plot.unit) for plot in plots(held)] == called


def test_signals_of_before_have_no_names() -> None:
    data = (Path(__file__).parent / "signals_of_before.parquet").read_bytes()
    assert [each.parts for each in decode_signals(data)[AT]] == [()]
