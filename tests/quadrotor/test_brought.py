"""Predictors, reconstructions and planners that a user brings."""

import os
import re
from pathlib import Path
from textwrap import dedent

import pytest
import yaml
from flights import bits, fly, quadrotor

from faultpath.api.systems import with_parts
from faultpath.core.errors import UserError
from faultpath.run.check.check import chosen_variants
from faultpath.run.code import system_code
from faultpath.run.plan import SystemSpec

ROOT = Path(__file__).parents[2]
PARTS = Path(__file__).with_name("own_parts.py")
PREDICTOR, EXACT, WIND, PLANNER, BLIND = (
    f"{PARTS}:{name}" for name in ("predictor", "exact", "wind", "planner", "blind")
)
STEPS = 6
pytestmark = pytest.mark.usefixtures("short")


def test_what_a_user_brings_stands_beside_what_ships():
    system = quadrotor(predictor=PREDICTOR, bring=f"{WIND},{PLANNER}")
    brought = {WIND, PREDICTOR, f"{PREDICTOR}/{WIND}", f"wm-a-wind/{WIND}", f"{PLANNER}/gru"}
    assert brought < set(system.variants)
    own, shipped = system.variants[f"{PREDICTOR}/{WIND}"], system.variants["dki-drag/dob"]
    assert own.bindings == shipped.bindings
    assert "reconstruction.wind_map" in own.readers
    assert "reconstruction.head" not in own.readers
    assert own.description == f"Prediction: Heavy of {PREDICTOR}. Wind: Constant of {WIND}."
    assert system.parts == (WIND, PLANNER, PREDICTOR)


@pytest.mark.parametrize(
    ("options", "first"),
    [
        ({"predictor": BLIND}, [BLIND]),
        ({"predictor": PREDICTOR}, ["zero-wind"]),
        ({"predictor": "wm-a+dcc"}, ["wm-a+dcc"]),
        ({"bring": f"{PLANNER},{WIND}"}, [f"{PLANNER}/{WIND}"]),
        ({"predictor": BLIND, "bring": WIND}, [BLIND, f"dki/{WIND}"]),
    ],
)
def test_what_the_options_name_flies_in_the_first_variants(options, first):
    """A check flies a few variants, and a trace one: they are to show what was named."""
    system = quadrotor(**options)
    assert list(system.variants)[: len(first)] == first
    checked = [variant.name for variant in chosen_variants(system, ())]
    assert checked[: len(first)] == first


@pytest.mark.filterwarnings("ignore::faultpath_quadrotor.native.kernel_args.PortableNotice")
def test_parts_fly_do_what_they_say_and_as_the_shipped_one_that_they_equal():
    system = quadrotor(bring=f"{WIND},{PLANNER},{EXACT}", wind="L2")
    (own,), _ = fly(system, f"{EXACT}/dob")
    assert bits(own) == bits(fly(system, "dki-drag/dob")[0][0])
    (_,), taps = fly(system, f"dki-drag/{WIND}")
    supplied = taps.delivered("wind", "predictor.wind_map")[:, 0]
    mass = taps.delivered("mass", "reconstruction.wind_map")[:, 0]
    assert (supplied[:, 0] == 2 * mass).all()
    assert (supplied[:, 2] == 0).all()
    (planned,), _ = fly(system, f"{PLANNER}/dob")
    (shipped,), _ = fly(system, "dob")
    assert planned.planner_noise_hash == shipped.planner_noise_hash


@pytest.mark.filterwarnings("ignore::faultpath_quadrotor.native.kernel_args.PortableNotice")
def test_a_variant_gets_a_part_of_its_own_with_the_seed_that_it_names():
    system = quadrotor(predictor=PREDICTOR, predictor_seed="1")
    named, chosen = system.variant_parts[PREDICTOR], system.variant_parts["gru"]
    assert (named.load_predictor(2).seed, chosen.load_predictor(2).seed) == (2, 1)
    assert named.load_predictor(None).seed is None
    assert named.load_predictor(2) is not named.load_predictor(2)


MISTAKES = yaml.safe_load(Path(__file__).with_name("brought.yaml").read_text("utf-8"))
BROKEN, FLOWN = MISTAKES["refused when brought"], MISTAKES["refused at first use"]
CREATE = "def create(seed) -> K:\n    "


def _file(folder: Path, code: str) -> Path:
    head = f"""\
        import sys
        from dataclasses import replace
        sys.path.append({str(PARTS.parent)!r})
        import torch
        from own_parts import Constant, K, planner
        from faultpath_quadrotor.planners import AutoregressiveSampler, SamplerSettings
        from faultpath_quadrotor.predictors import KinematicIntegrator
        """
    path = folder / "mine.py"
    path.write_text(dedent(head) + "\n" + code + "\n")
    return path


@pytest.mark.parametrize("name", BROKEN)
def test_a_part_that_cannot_be_brought_is_refused_in_a_sentence(name, tmp_path):
    code, says = BROKEN[name]["code"], BROKEN[name]["says"]
    named = f"{'nowhere.py' if code is None else _file(tmp_path, code)}:create"
    with pytest.raises(UserError, match=rf"\A.*{re.escape(says)}.*\Z"):
        system_code(quadrotor(bring=named), SystemSpec(name="quadrotor"))


@pytest.mark.parametrize("name", FLOWN)
def test_a_part_that_does_another_thing_is_refused_at_first_use(name, tmp_path):
    code, says = FLOWN[name]["code"], FLOWN[name]["says"]
    named = f"{_file(tmp_path, code)}:create"
    with pytest.raises(UserError, match=re.escape(says)):
        fly(quadrotor(bring=named), f"dki-drag/{named}" if "Constant" in code else named)


def test_code_and_data_of_a_part_are_part_of_what_flies(tmp_path):
    code = f"import helper_of_a_part\n{CREATE}k = K(); k.data_files = ['w.bin']; return k"
    path = _file(tmp_path, code)
    helper, data = tmp_path / "helper_of_a_part.py", tmp_path / "w.bin"
    helper.write_text("GAIN = 1\n")
    data.write_bytes(b"1")
    brought = {"bring": f"{path}:create"}
    spec = SystemSpec(name="quadrotor", options=brought)

    def state():
        return system_code(quadrotor(**brought), spec).state

    first = state()
    assert state().digest == first.digest
    assert {"mine.py", "helper_of_a_part.py"} <= set(first.files)
    data.write_bytes(b"2")
    second = state()
    path.write_text(path.read_text() + "\nMORE = 1\n")
    assert len({each.digest for each in (first, second, state())}) == 3


def test_variants_name_what_is_brought():
    def given(variants, system="quadrotor", **options):
        return with_parts(SystemSpec(name=system, options=options), variants).options

    brought = given(("gru", "a/b.py:create/gru"), wind="L1")
    assert brought == {"wind": "L1", "bring": "a/b.py:create"}
    brought = given(("a.py:x/b.py:y", "zero-wind"), bring="a.py:x")
    assert brought == {"bring": "a.py:x,b.py:y"}
    assert given(("gru", "gru+dcc")) == {}
    assert given(("a.py:create", "blind"), f"{ROOT / 'examples' / 'toy.py'}:create") == {}
    with pytest.raises(UserError, match=r"'a\.py:create'"):
        given(("a.py", "gru"))
    with pytest.raises(UserError, match="or name your own as"):
        quadrotor(predictor="my_model")
    assert quadrotor(bring=f"wm-a-wind/{os.path.relpath(WIND)}").parts == (os.path.relpath(WIND),)
