"""What counts as the code of a trial: all that runs in one."""

import sys
from pathlib import Path

import pytest

from faultpath.faults import at_readers
from faultpath.run.attempt import Done, attempt
from faultpath.run.code import source_state, system_code
from faultpath.run.plan import SystemSpec, Treatment
from faultpath.run.registry import load_system

ROOT = Path(__file__).resolve().parents[2]
FLOWN = {
    "toy": (f"{ROOT}/examples/toy.py:create", {}, "carts", "calibrated", "gain:scale=0.6"),
    "dock": (f"{ROOT}/examples/dock.py:create", {}, "floors", "ranges", "range:scale=0.7"),
    "quadrotor": ("quadrotor", {"wind": "L3"}, "selection", "gru", "calibration=+0.1"),
    "quadrotor on the portable path": (
        "quadrotor",
        {"wind": "L1", "environment": "free-space"},
        "selection",
        "wm-u",
        "calibration=+0.1",
    ),
}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow if "quadrotor" in name else ()) for name in FLOWN],
)
def test_whatever_runs_in_a_flight_counts(name, monkeypatch):
    if "quadrotor" in name:  # all that runs in a flight runs in a short one
        monkeypatch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", 8)
    if "portable" in name:
        monkeypatch.setenv("FAULTPATH_KERNELS", "portable")
    place, options, library, variant, text = FLOWN[name]
    spec = SystemSpec(name=place, options=options)
    system = load_system(spec)
    scenes = [scene.id for scene in system.library(library).scenes[:1]]
    faults = at_readers(system.fault(text), system.variants[variant].readers)
    code = system_code(system, spec)

    ran: set[str] = set()
    sys.setprofile(lambda frame, event, _: ran.add(frame.f_code.co_filename))
    try:
        done = attempt(system, Treatment(variant=variant, faults=faults), scenes)
    finally:
        sys.setprofile(None)
    assert isinstance(done, Done), done
    ours = {
        Path(file).resolve()
        for file in ran
        if Path(file).is_relative_to(ROOT) and "src" in Path(file).parts
    }
    assert len(ours) > 5
    assert ours <= {path.resolve() for path in code.sources}


@pytest.mark.parametrize("name", ["toy", "quadrotor"])
def test_the_code_is_known_before_loading(name):
    place, options, *_ = FLOWN[name]
    spec = SystemSpec(name=place, options=options)
    assert source_state(spec).files == system_code(load_system(spec), spec).state.files
