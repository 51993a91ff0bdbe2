"""A library of one's own, from its making to its report."""

import json
from pathlib import Path

from cli_runs import audit, faultpath
from faultpath_quadrotor import native
from faultpath_quadrotor.scenes.library import Library, as_text, load_library

from faultpath.api.runs import open_run


def test_a_library_of_ones_own_is_flown_and_reported(monkeypatch):
    monkeypatch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", 3)
    scenes = tuple(
        scene.model_copy(update={"library": "mine", "id": f"mine/{scene.index:03d}"})
        for scene in load_library("selection").scenes[:2]
    )
    Path("mine.json").write_text(as_text(Library.of("mine", scenes)))
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
    facts = record.facts
    assert (facts.n_scenes, record.question.options) == (2, {"wind": "L1"})
    assert facts.library_hash == json.loads(Path("mine.json").read_text())["content_hash"]
    names = [condition.name for condition in record.conditions]
    assert names == ["correct", "predictor", "reconstruction", "shared"]

    page = Path("run/report.html").read_bytes()
    Path("run/report.html").unlink()
    assert faultpath("report", "run").status == 0
    assert Path("run/report.html").read_bytes() == page
    assert b"mine/001" in page

    backend = native.describe()
    assert f"Computing with {backend}." in ended.out
    assert json.loads(Path("run/provenance.json").read_text())["machine"]["backend"] == backend
    assert backend.encode() in page
