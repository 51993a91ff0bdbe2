"""Wrong arguments of systems and plants are answered where they are handed over."""

import re
from pathlib import Path

import numpy as np
import pytest

from faultpath.core.error_source import location
from faultpath.core.errors import SystemMistake
from faultpath.run.check.blocks import BlockSpec, run_block
from faultpath.run.plan import SystemSpec, Treatment
from faultpath.run.registry import load_system
from faultpath.system import library_of

OWN = Path(__file__).parents[2] / "src/faultpath/system/templates/numpy.py.txt"
CALL = '"own", plant, variants, units)'
MISTAKES = {
    "number of scenes": (CALL, CALL[:-1] + ", scenes={'few': 20})", "'few' is 20: give the seeds"),
    "text": (CALL, CALL[:-1] + ", scenes={'few': 'abc'})", "library 'few' is 'abc': give the"),
    "half a seed": (CALL, CALL[:-1] + ", scenes={'few': [1.5]})", r"'few' is \[1.5\]: give the"),
    "no scene": (CALL, CALL[:-1] + ", scenes={'few': []})", "library 'few' is empty: give at"),
    "no library": (CALL, CALL[:-1] + ", scenes=range(9))", r"scenes is range\(0, 9\): give a map"),
    "a channel of none": (CALL, CALL[:-1] + ", channels={'x': 3})", "'x' is 3: give a list of its"),
    "a channel of text": (CALL, CALL[:-1] + ", channels={'x': 'a'})", "'x' is 'a': give a list"),
    "action": ('action="push"', 'action="pusch"', "plant's action names.*'pusch'; did you mean 'p"),
    "a unit's name": ('"slope": "m', '"slop": "m', "units names 'slop', .* did you mean 'slope'"),
    "a unit left out": ('"slope": "m/s^2",', "", "'slope' has no unit: add it to units"),
    "a number for a unit": (
        '"slope": "m/s^2"',
        '"slope": 3',
        "'slope' has 3: give its unit as text",
    ),
    "units by place": ("units = {", "units = 3; _ = {", "units is 3: give a mapping by name"),
    "variants by place": (
        "variants = {",
        "variants = [1]; _ = {",
        r"variants is \[1\]: give a map",
    ),
    "a module alone": ("[typical, controller]", "typical", "FunctionModule object>: give a list"),
    "a function": (
        '@writes("push", before=0.0)\n',
        "",
        "the function controller, which is no modu",
    ),
    "no steps": ("steps=100", "steps=0", "steps is 0: give a whole number"),
    "steps as text": ("steps=100", "steps='100'", "steps is '100': give a whole number"),
    "time backwards": ("dt_s=DT_S", "dt_s=-0.1", "dt_s is -0.1: give the seconds"),
    "no time": ("dt_s=DT_S", "dt_s=float('nan')", "dt_s is nan: give the seconds"),
    "success": (
        "succeeded=lambda episode: ",
        "succeeded='yes' if 1 else ",
        "succeeded is 'yes': gi",
    ),
    "metric": (
        'Measure(Metric(unit="m", better="less"), missed_m)',
        "missed_m",
        "metrics: 'missed_m' is <function missed_m>: give a Measure",
    ),
    "a unit that is left over": (
        '"slope": "m',
        '"slopes": "m", "slope": "m',
        "units names 'slopes', which is no source; did you mean 'slope'",
    ),
    "a default": (
        "observer(speed, push, gain, memory)",
        "observer(speed, push, gain, memory, prior=0.5)",
        "'prior' has a default and is no source: give constants with `.given.prior=0.5.`",
    ),
    "its own past": (
        '@writes("slope", past="push")\ndef observer(speed',
        '@writes("slope", past=("push", "slope"))\ndef observer(slope, speed',
        "'observer': it reads 'slope', which it writes itself: keep the value .* in `memory`",
    ),
    "a name with a capital letter": (
        'past="push")',
        'past="push", name="Observer")',
        "'Observer' cannot name a module, a place or a channel: use small letters",
    ),
    "a channel that is misspelt": (
        CALL,
        CALL[:-1] + ", channels={'sped': ['speed']})",
        "no module reads what channels names: unknown channel 'sped'; did you mean 'speed'",
    ),
    "no return": (
        "    return (-place",
        "    (-place",
        "module 'controller' returned None: is a `return` missing",
    ),
    "a module of one variant alone": (
        "[typical, controller]",
        "[controller]",
        "variant 'typical': channel 'slope' is bound to source 'slope', which neither",
    ),
    "a step without noise": (
        "def step(state, push, rng)",
        "def step(state, push)",
        r"`step` takes \(state, push\), but it is called as step\(state, action, rng\)",
    ),
    "over": (
        "steps=100,",
        "steps=100, over=lambda: True,",
        r"called as over\(state\): give it 1 a",
    ),
    "render": (
        "steps=100,",
        "steps=100, render=lambda state: [1, 2],",
        r"`render` must return points .*; it returned \[1, 2\]",
    ),
    "start": ('return {"place"', '{"place"', "`start` returned nothing: it must return the state"),
}


@pytest.fixture
def own(tmp_path):
    def load(before: str, after: str):
        text = OWN.read_text().replace('"NAME"', '"own"')
        assert before in text
        file = tmp_path / "own.py"
        file.write_text(text.replace(before, after, 1))
        return load_system(SystemSpec(name=f"{file}:create"))

    return load


@pytest.mark.parametrize(("before", "after", "sentence"), MISTAKES.values(), ids=MISTAKES.keys())
def test_a_wrong_argument_is_told_with_its_line_and_what_to_give(
    own, before, after, sentence
) -> None:
    with pytest.raises(SystemMistake, match=sentence) as mistake:
        own(before, after)
    assert "own.py, line " in (mistake.value.location or location(mistake.value))


@pytest.mark.parametrize(
    ("before", "after", "sentence"),
    [
        (
            "episode: missed_m(episode) <",
            "episode: 0 * missed_m(episode) +",
            "`succeeded` ret.* it must return true or false",
        ),
        (
            "steps=100,",
            "steps=100, over=lambda state: [True],",
            r"`over` returned \[True\] of the state.* it must return true or false",
        ),
        (
            '"less"), missed_m',
            '"less"), lambda episode: "far"',
            "metric 'missed_m' is 'far' of an episode: it must be a number",
        ),
    ],
)
def test_a_wrong_value_of_a_function_is_told_with_its_line(own, before, after, sentence) -> None:
    system = own(before, after)
    run = run_block(system, BlockSpec(Treatment(variant="typical", seed=0), ("seed/0",)))
    assert re.search(f"own.py, line [0-9]+: {sentence}", run.error)


def test_seeds_may_be_an_array(own) -> None:
    system = own(CALL, CALL[:-1] + ", scenes={'few': __import__('numpy').arange(3, 5)})")
    assert tuple(scene.id for scene in library_of(system, "few").scenes) == ("seed/3", "seed/4")


def test_a_step_that_returns_nothing_is_told(own) -> None:
    plant = own('return state | {"speed"', 'state | {"speed"').plant()
    with pytest.raises(SystemMistake, match="`step` returned nothing: it must return") as mistake:
        plant.world("seed/0", 0).step(np.zeros(()), 0)
    assert "own.py, line " in mistake.value.location
