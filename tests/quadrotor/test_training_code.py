"""What counts as the code of the data that models learn from."""

import sys
from pathlib import Path

import pytest
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training import clearance_data, flight, trajectories
from faultpath_quadrotor.training.pool import write_flights

from faultpath.trials.code import read_code
from faultpath.trials.imports import Root

ROOT = Path(__file__).resolve().parents[2]


def _pool(folder: Path) -> None:
    write_flights(folder / "batch", range(1), flight.fly("wind", range(1), 0))


def _closed_loop(folder: Path) -> None:
    system = Quadrotor.parse(wind="L1", clearance="true", environment="free-space")
    scene = system.library("selection").scenes[0].id
    flights = trajectories.record_flights(system, "wm-a-wind/true-wind", (scene,), 0)
    write_flights(folder / "batch", range(1), flights)


def _images(folder: Path) -> None:
    recipe = clearance_data.ClearanceRecipe(images=1, in_view=16, near_surface=16, around=8)
    clearance_data.draw(recipe, load_library(recipe.library).scenes[0])


@pytest.mark.parametrize(
    ("make", "roots"),
    [
        (_pool, ["training.flight", "training.pool"]),
        (_images, ["training.clearance_data"]),
        pytest.param(_closed_loop, ["system", "training.trajectories"], marks=pytest.mark.slow),
    ],
    ids=["episodes", "images", "closed loop"],
)
def test_whatever_runs_while_data_are_made_counts(make, roots, tmp_path, monkeypatch):
    monkeypatch.setattr(flight, "EPISODE_STEPS", 10)
    monkeypatch.setattr(flight, "EPISODE_S", 0.5)
    ran: set[str] = set()
    sys.setprofile(lambda frame, event, _: ran.add(frame.f_code.co_filename))
    try:
        make(tmp_path)
    finally:
        sys.setprofile(None)
    counted = read_code([Root(f"faultpath_quadrotor.{root}") for root in roots]).sources
    files = [Path(file) for file in ran if "/src/faultpath" in file]
    ours = {file.resolve() for file in files if file.is_relative_to(ROOT)}
    assert len(ours) > 5
    assert ours <= {path.resolve() for path in counted.values()}
