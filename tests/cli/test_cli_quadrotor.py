"""A library of one's own, from its making to its report."""

import json
from pathlib import Path

from cli_runs import audit, faultpath
from faultpath_quadrotor import native
from faultpath_quadrotor.scenes.library import Library, as_text, load_library

from faultpath.api.runs import open_run
from faultpath.trials import SystemSpec, load_system


def write_library(count):
    """Write a library of one's own, of scenes of the package under other names."""
    scenes = tuple(
        scene.model_copy(update={"library": "mine", "id": f"mine/{scene.index:03d}"})
        for scene in load_library("selection").scenes[:count]
    )
    Path("mine.json").write_text(as_text(Library.of("mine", scenes)))


def test_a_library_of_ones_own_is_flown_and_reported(monkeypatch):
    monkeypatch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", 3)
    write_library(2)
    ended = audit(
        system="quadrotor",
        baseline="zero-wind",
        repair="dob",
        fault="calibration=0.1",
        library="mine.json",
        scenes=2,
        wind="L1",
        out="run",
    )
    assert (ended.status, ended.err) == (0, "")
    record = open_run("run").record
    question = record.question
    assert question.n_scenes == 2
    assert question.options == {"wind": "L1"}
    assert question.library_hash == json.loads(Path("mine.json").read_text())["content_hash"]
    names = [path.name for path in record.paths]
    assert names == ["correct", "predictor", "reconstruction", "shared"]

    page = Path("run/report.html")
    before = page.read_bytes()
    page.unlink()
    again = faultpath("report", "run")
    assert (again.status, again.err) == (0, "")
    assert page.read_bytes() == before
    assert b"mine/001" in before

    backend = native.describe()
    assert f"Computing with {backend}." in ended.out
    assert json.loads(Path("run/provenance.json").read_text())["backend"] == backend
    assert backend.encode() in before


def test_a_worker_finds_a_library_file():
    """What a worker is told is the system and the library's name, and no more."""
    write_library(1)
    system = load_system(SystemSpec(name="quadrotor"))
    library = system.library("mine.json")
    assert load_system(SystemSpec(name="quadrotor")).library(library.name) == library
