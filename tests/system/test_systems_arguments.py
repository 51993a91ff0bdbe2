"""Wrong arguments of systems and plants are answered where they are handed over."""

import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from faultpath.core.error_source import location
from faultpath.core.errors import SystemMistake
from faultpath.run.check.blocks import BlockSpec, run_block
from faultpath.run.plan import SystemSpec, Treatment
from faultpath.run.registry import load_system
from faultpath.system import library_of

OWN = Path(__file__).parents[2] / "src/faultpath/system/templates/numpy.py.txt"
MISTAKES = yaml.safe_load(Path(__file__).with_name("mistakes.yaml").read_text("utf-8"))


@pytest.fixture
def own(tmp_path):
    def load(before: str, after: str):
        text = OWN.read_text().replace('"NAME"', '"own"')
        assert before in text
        file = tmp_path / "own.py"
        file.write_text(text.replace(before, after, 1))
        return load_system(SystemSpec(name=f"{file}:create"))

    return load


@pytest.mark.parametrize(("before", "after", "sentence"), MISTAKES["declared"])
def test_a_wrong_argument_is_told_with_its_line_and_what_to_give(
    own, before, after, sentence
) -> None:
    with pytest.raises(SystemMistake, match=sentence) as mistake:
        own(before, after)
    assert "own.py, line " in (mistake.value.location or location(mistake.value))


@pytest.mark.parametrize(("before", "after", "sentence"), MISTAKES["flown"])
def test_a_wrong_value_of_a_function_is_told_with_its_line(own, before, after, sentence) -> None:
    system = own(before, after)
    run = run_block(system, BlockSpec(Treatment(variant="typical", seed=0), ("seed/0",)))
    assert re.search(f"own.py, line [0-9]+: {sentence}", run.error)


def test_seeds_may_be_an_array(own) -> None:
    system = own(
        "variants, units)", "variants, units, scenes={'few': __import__('numpy').arange(3, 5)})"
    )
    assert tuple(scene.id for scene in library_of(system, "few").scenes) == ("seed/3", "seed/4")


def test_a_step_that_returns_nothing_is_told(own) -> None:
    plant = own('return state | {"speed"', 'state | {"speed"').plant()
    with pytest.raises(SystemMistake, match="`step` returned nothing: it must return") as mistake:
        plant.world("seed/0", 0).step(np.zeros(()), 0)
    assert "own.py, line " in mistake.value.location
