"""A library of one's own, and a predictor, reconstruction and planner named where a variant is."""

import json
import re
import warnings
from pathlib import Path

import pytest
from cli_runs import ROOT, Ended, audit, faultpath
from faultpath_quadrotor import native
from faultpath_quadrotor.plant import module
from faultpath_quadrotor.scenes.library import SceneLibrary, as_text, load_library

from faultpath.api.runs import open_run
from faultpath.core.errors import Notice

PARTS = ROOT / "tests" / "quadrotor" / "own_parts.py"
SHORT = """
from faultpath_quadrotor.plant import module
module.CONTROL_STEPS = 3  # in worker processes, as the tests have it in their own
"""

pytestmark = pytest.mark.filterwarnings(
    "ignore::faultpath_quadrotor.native.kernel_args.PortableNotice"
)


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "CONTROL_STEPS", 3)
    (tmp_path / "mine.py").write_text(PARTS.read_text() + SHORT)
    scenes = tuple(
        scene.model_copy(update={"library": "mine", "id": f"mine/{scene.index:03d}"})
        for scene in load_library("selection").scenes[:2]
    )
    (tmp_path / "mine.json").write_text(as_text(SceneLibrary.of("mine", scenes)))


def _audit(baseline: str, repair: str, **options: object) -> Ended:
    question = {"system": "quadrotor", "fault": "calibration=0.1", "scenes": 2, "out": "run"}
    question |= {"library": "mine.json", "environment": "free-space"}
    return audit(**question | {"baseline": baseline, "repair": repair} | options)


def test_a_part_and_a_library_of_ones_own_are_audited_and_reported():
    for kept in (False, True):
        ended = _audit("mine.py:exact", "mine.py:exact/mine.py:wind")
        assert ended.status == 0, ended.err
        assert bool(re.search(r"Kept (\d+) of \1 trials", ended.err)) == kept
    record = open_run("run").record
    question = record.question
    assert question.repair == "mine.py:exact/mine.py:wind"
    assert question.options == {"environment": "free-space", "bring": "mine.py:exact,mine.py:wind"}
    assert record.facts.library_hash == json.loads(Path("mine.json").read_text())["content_hash"]
    names = [condition.name for condition in record.conditions]
    assert names == ["correct", "predictor", "reconstruction", "shared"]

    page = Path("run/report.html").read_bytes()
    Path("run/report.html").unlink()
    assert faultpath("report", "run").status == 0
    assert Path("run/report.html").read_bytes() == page
    assert b"mine/001" in page
    backend = native.describe()
    assert f"Computing with {backend}." in ended.err
    assert json.loads(Path("run/provenance.json").read_text())["machine"]["backend"] == backend
    assert backend.encode() in page

    Path("mine.py").write_text(Path("mine.py").read_text().replace("drag=True", "drag=False"))
    _audit("mine.py:exact", "mine.py:exact/mine.py:wind").refused("mine.py")


@pytest.mark.slow
def test_workers_build_the_part_too_and_what_they_find_is_shown_once():
    own = {"predictor": "mine.py:Heavy", "fault": "calibration=0.1@predictor"}
    with warnings.catch_warnings():
        warnings.simplefilter("default", Notice)
        ended = _audit("zero-wind", "mine.py:wind", **own, workers=2, scenes=1)
    assert ended.status == 0, ended.err
    (line,) = [line for line in ended.err.splitlines() if line.startswith("faultpath: ")]
    assert line.startswith("faultpath: The predictor Heavy runs on the portable path")


@pytest.mark.parametrize(
    ("repair", "name"),
    [
        ("mine.py", "'mine.py:create'"),
        ("other.py:create", "'other.py'"),
        ("mine.py:OPTIONS", "'OPTIONS'"),
        ("mine.py:exact/gur", "did you mean 'mine.py:exact/gru'"),
    ],
)
def test_a_mistake_is_one_sentence(repair, name):
    _audit("wm-a", repair).refused(name)
