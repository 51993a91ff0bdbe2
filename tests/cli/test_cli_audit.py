"""`faultpath audit` from end to end, and what it does in a folder that holds something."""

import json
import re
import shutil
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from cli_runs import ROOT, Ended, audit, shards
from written import written

from faultpath.analyses.model import SHARED
from faultpath.api.runs import open_run

FILES = {
    *("manifest.json", "outcomes.parquet", "traces.parquet", "record.json", "provenance.json"),
    *("system.json", "report.html", "table.md", "signals.parquet"),
}
BROKEN = """def __init__(self, where):
    self.where = where
def run(self, variant, scenes, taps, seed):
    if any(scene.startswith(self.where) for scene in scenes):
        raise ZeroDivisionError("the [cart] has no wheels")
    return super().run(variant, scenes, taps, seed)"""
SCENES = 40


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Ended]:
    """A run folder, and how the audit that made it ended."""
    folder = tmp_path_factory.mktemp("toy") / "run"
    ended = again(folder)
    assert ended.status == 0, ended.err
    assert str(folder / "report.html") in ended.out
    return folder, ended


@pytest.fixture
def run(first: tuple[Path, Ended]) -> Path:
    return first[0]


def again(folder: Path, *arguments: object) -> Ended:
    return audit(*arguments, scenes=SCENES, out=folder)


def test_an_audit_leaves_its_files_and_shows_the_reversal(run):
    assert {condition.name for condition in run.iterdir()} >= FILES
    record = open_run(run).record
    assert [condition.name for condition in record.conditions] == [
        "correct",
        "controller",
        "observer",
        SHARED,
    ]
    assert {change.isolated: change.turn for change in record.changes}["observer"] == "reversal"
    signs = [effect.sign for effect in record.effects if effect.condition in ("observer", SHARED)]
    assert signs == [1, -1]
    recorded = pq.read_table(run / "signals.parquet").to_pydict()
    assert {"blind"} <= set(recorded["variant"])
    assert {SHARED} <= set(recorded["condition"])


def test_a_second_time_everything_is_kept_and_json_is_all_of_the_standard_output(run):
    before = {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in shards(run)}
    outcomes = (run / "outcomes.parquet").read_bytes()
    ended = again(run, "--json")
    assert ended.status == 0
    (printed,) = json.loads(ended.out)
    assert printed["folder"] == str(run)
    assert printed["record"] == json.loads((run / "record.json").read_text())
    assert printed["headline"] in (run / "table.md").read_text()
    assert printed["sentences"]
    assert printed["would_change"]
    assert {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in shards(run)} == before
    assert (run / "outcomes.parquet").read_bytes() == outcomes
    assert json.loads((run / "provenance.json").read_text())["blocks_computed"] == 0


def test_progress_and_notices_stay_out_of_the_standard_output(first):
    folder, ended = first
    second = again(folder)
    assert ended.out == second.out
    assert ended.out.startswith("Do not choose by the fault at the observer alone")
    assert "Running: 320 of 320 trials" in ended.err
    assert "Recording signals: " in ended.err
    assert second.err.startswith("Kept 320 of 320 trials")


def test_without_a_folder_the_run_is_called_after_its_question_and_not_its_place(tmp_path):
    for place, fault in (("one", "0.6"), ("one", "0.5"), ("two", "0.6")):
        (tmp_path / place).mkdir(exist_ok=True)
        system = f"{shutil.copy(ROOT / 'examples' / 'toy.py', tmp_path / place)}:create"
        question = {"system": system, "scenes": 2, "seeds": "3", "fault": f"gain:scale={fault}"}
        assert audit("--no-signals", **question).status == 0
    names = sorted(folder.name for folder in Path("runs").iterdir())
    assert len(names) == 3
    for name, fault in zip(names, ("0.5", "0.6", "0.6"), strict=True):
        words = f"toy.py_create-blind-vs-calibrated-gain_scale={fault}-carts-2-scenes-seeds-3"
        assert name.startswith(words)
        assert tmp_path.name not in name
    assert not list(Path("runs").rglob("signals.parquet"))


def test_another_metric_of_the_kept_trials_runs_nothing():
    assert audit(scenes=2).status == 0
    (folder,) = Path("runs").iterdir()
    ended = audit("--metric", "terminal_distance_m", "--thresholds", "0.1,0.5", scenes=2)
    assert ended.status == 0
    assert "Kept 16 of 16 trials" in ended.err
    assert list(Path("runs").iterdir()) == [folder]
    assert open_run(folder).record.question.metric == "terminal_distance_m"


def test_a_failed_trial_is_shown_and_the_status_says_so():
    system = written(Path(), BROKEN)
    for _ in ("at first", "and again"):
        ended = audit(system=system, set="where=cart/003", out="run")
        assert ended.status == 1
        assert "Traceback" not in ended.out + ended.err
        assert re.search(r"cart/003 .*ZeroDivisionError: the \[cart\] has no wheels", ended.err)
        (place,) = set(re.findall(r"\((\S+failures\S+\.txt)\)", ended.err)[:1])
        assert "has no wheels" in Path(place).read_text()
    effect = open_run("run").record.effects[0]
    assert (effect.void, effect.scenes) == (1, 5)
    assert re.search(r"^Shared fault .* 5 +1 ", ended.out, re.MULTILINE), "scenes, then void pairs"
