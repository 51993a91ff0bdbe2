"""`faultpath audit` from end to end, and what it does in a folder that holds something."""

import json
import os
import re
import shutil
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from cli_runs import HERE, ROOT, audit, faultpath, shards

from faultpath.api.runs import open_run
from faultpath.decisions.model import SHARED

FILES = {
    "manifest.json",
    "outcomes.parquet",
    "traces.parquet",
    "record.json",
    "provenance.json",
    "system.json",
    "report.html",
    "table.md",
}
BROKEN = f"{HERE / 'systems' / 'slow_toy.py'}:broken"


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="module")
def toy_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run the command of the example as it stands there, in the root of the project."""
    folder = tmp_path_factory.mktemp("toy") / "run"
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        line = ["audit", "examples/toy.py:create", "--baseline", "calibrated", "--repair", "blind"]
        line += ["--fault", "gain:scale=0.6", "--library", "carts"]
        ended = faultpath(*line, "--out", folder, "--workers", 0)
    assert ended.status == 0, ended.err
    assert ended.err == ""
    assert str(folder / "report.html") in ended.out
    return folder


@pytest.fixture
def run(toy_run: Path, tmp_path: Path) -> Path:
    """A copy of that run, to damage."""
    return Path(shutil.copytree(toy_run, tmp_path / "run"))


def test_json_is_the_record_and_nothing_else_on_the_standard_output(run, monkeypatch):
    monkeypatch.chdir(ROOT)
    ended = audit("--json", scenes=100, out=run, system="examples/toy.py:create")
    assert ended.status == 0
    (told,) = json.loads(ended.out)
    assert told == {"folder": str(run), "record": json.loads((run / "record.json").read_text())}


def test_signals_are_heard_right_after_the_audit(tmp_path):
    ended = audit(out="run")
    assert ended.status == 0, ended.err
    assert "Recording signals" in ended.out
    addresses = {tuple(address) for address in zip(*_columns("run/signals.parquet"), strict=True)}
    assert {scene for _, _, scene in addresses} <= {f"cart/{i:03}" for i in range(6)}
    assert {(variant, path) for variant, path, _ in addresses} >= {("blind", SHARED)}
    ended = audit("--no-signals", out="plain")
    assert ended.status == 0, ended.err
    assert not Path("plain/signals.parquet").exists()


def _columns(file: str) -> list[list[str]]:
    table = pq.read_table(file)
    return [table.column(name).to_pylist() for name in ("variant", "path", "scene")]


def _again(folder: Path, **options: object):
    return audit(scenes=100, out=folder, system="examples/toy.py:create", **options)


def test_the_toy_shows_the_reversal(toy_run):
    assert {path.name for path in toy_run.iterdir()} >= FILES
    record = open_run(toy_run).record
    assert [path.name for path in record.paths] == ["correct", "controller", "observer", SHARED]
    turns = {change.isolated: change.turn for change in record.changes}
    assert turns == {"controller": "interaction", "observer": "reversal"}
    effects = {effect.path: effect for effect in record.effects}
    assert effects["observer"].detected
    assert effects["observer"].success.value > 0
    assert effects[SHARED].detected
    assert effects[SHARED].success.value < 0
    assert "observer" in record.headline


def test_reports_are_made_again_from_what_is_stored(run, monkeypatch):
    monkeypatch.chdir(ROOT)
    before = {name: (run / name).read_bytes() for name in ("report.html", "table.md")}
    for name in before:
        (run / name).unlink()
    ended = faultpath("report", run)
    assert (ended.status, ended.err) == (0, "")
    assert {name: (run / name).read_bytes() for name in before} == before


@pytest.mark.parametrize("name", ["record.json", "outcomes.parquet"])
@pytest.mark.parametrize("damage", ["missing", "cut"])
def test_a_damaged_run_is_not_reported(name, damage, run, monkeypatch):
    monkeypatch.chdir(ROOT)
    path = run / name
    if damage == "missing":
        path.unlink()
    else:
        path.write_bytes(path.read_bytes()[:40])
    assert name in faultpath("report", run).refused()


def test_a_second_time_everything_is_kept(run, monkeypatch):
    monkeypatch.chdir(ROOT)
    before = (run / "outcomes.parquet").read_bytes()
    times = {path: path.stat().st_mtime_ns for path in shards(run)}
    assert _again(run).status == 0
    assert {path: path.stat().st_mtime_ns for path in shards(run)} == times
    assert (run / "outcomes.parquet").read_bytes() == before
    assert json.loads((run / "provenance.json").read_text())["blocks_computed"] == 0


@pytest.mark.parametrize("damage", [b"", b"PAR1 no more", None], ids=["empty", "other", "cut"])
def test_a_damaged_shard_is_named_and_run_again(damage, run, monkeypatch):
    monkeypatch.chdir(ROOT)
    before = (run / "outcomes.parquet").read_bytes()
    hurt = shards(run)[3]
    sound = hurt.read_bytes()
    hurt.write_bytes(sound[: len(sound) // 2] if damage is None else damage)
    ended = _again(run)
    assert (ended.status, ended.err) == (0, "")
    assert f"{hurt} is damaged" in ended.out
    assert hurt.read_bytes() == sound
    assert (run / "outcomes.parquet").read_bytes() == before
    assert json.loads((run / "provenance.json").read_text())["blocks_computed"] == 1


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"fault": "gain:scale=0.7"}, "set of variants, faults or seeds"),
        ({"seeds": "1"}, "set of variants, faults or seeds"),
        ({"baseline": "blind", "repair": "calibrated"}, "study"),
    ],
)
def test_a_folder_of_another_study_is_left_alone(options, says, run, monkeypatch):
    monkeypatch.chdir(ROOT)
    before = {p: p.read_bytes() for p in run.rglob("*") if p.is_file() and p.name != ".lock"}
    sentence = _again(run, **options).refused()
    assert str(run) in sentence
    assert says in sentence
    after = {p: p.read_bytes() for p in run.rglob("*") if p.is_file() and p.name != ".lock"}
    assert after == before


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"faultpath_version": "0.0.0"}, "another version of faultpath"),
        ({"format": 99}, "format 99"),
        (
            {"code": {"files": {"toy.py": "0"}, "packages": {}, "python": "3"}},
            "other code than this (changed since: ",
        ),
        ({"study": 3}, "cannot be read as a manifest"),
        ({"library_hash": "0"}, "another state of the library"),
    ],
)
def test_a_folder_of_another_version_is_left_alone(change, says, run, monkeypatch):
    monkeypatch.chdir(ROOT)
    manifest = run / "manifest.json"
    manifest.write_text(json.dumps(json.loads(manifest.read_text()) | change))
    before = {path: path.read_bytes() for path in shards(run)}
    assert says in _again(run).refused()
    assert {path: path.read_bytes() for path in shards(run)} == before


def test_a_quick_look_grows_into_the_whole(toy_run, tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    out = tmp_path / "look"
    assert audit(scenes=20, out=out, system="examples/toy.py:create").status == 0
    assert open_run(out).record.question.n_scenes == 20
    assert _again(out).status == 0
    assert (out / "outcomes.parquet").read_bytes() == (toy_run / "outcomes.parquet").read_bytes()
    assert json.loads((out / "provenance.json").read_text())["blocks_kept"] > 0


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written(tmp_path):
    place = tmp_path / "locked"
    place.mkdir(mode=0o500)
    assert str(place) in audit(out=place).refused()
    assert str(place / "below") in audit(out=place / "below").refused()


def test_without_a_folder_the_run_is_called_after_its_question(tmp_path):
    assert audit(scenes=2, seeds="3").status == 0
    (folder,) = (tmp_path / "runs").iterdir()
    for part in ("blind-vs-calibrated", "gain_scale=0.6", "carts", "2-scenes", "seeds-3"):
        assert part in folder.name
    assert audit(scenes=2, seeds="3", fault="gain:scale=0.5").status == 0
    assert len(list((tmp_path / "runs").iterdir())) == 2


def test_another_metric_of_the_kept_trials_runs_nothing(tmp_path):
    assert audit(scenes=2).status == 0
    (folder,) = (tmp_path / "runs").iterdir()
    times = {path: path.stat().st_mtime_ns for path in shards(folder)}
    for more in ([], ["--thresholds", "0.1,0.5"]):
        ended = audit("--metric", "terminal_distance_m", *more, scenes=2)
        assert ended.status == 0
        assert "Kept 16 of 16 trials" in ended.out
    assert list((tmp_path / "runs").iterdir()) == [folder]
    assert {path: path.stat().st_mtime_ns for path in shards(folder)} == times
    assert open_run(folder).record.question.metric == "terminal_distance_m"


def test_the_name_of_a_run_says_nothing_of_where_its_system_is(tmp_path):
    for place in ("one", "two"):
        system = tmp_path / place / "toy.py"
        system.parent.mkdir()
        shutil.copy(ROOT / "examples" / "toy.py", system)
        assert audit(system=f"{system}:create", scenes=2).status == 0
    folders = [*(tmp_path / "runs").iterdir()]
    assert len(folders) == 2
    for folder in folders:
        assert folder.name.startswith("toy.py_create-blind-vs-calibrated-gain_scale=0.6-carts-")
        assert tmp_path.name not in folder.name


def test_after_an_edit_a_run_starts_anew_beside_the_other(tmp_path):
    system = tmp_path / "mine" / "toy.py"
    system.parent.mkdir()
    shutil.copy(ROOT / "examples" / "toy.py", system)
    assert "has changed" not in audit(system=f"{system}:create").out
    (before,) = (tmp_path / "runs").iterdir()
    outcomes = (before / "outcomes.parquet").read_bytes()
    again = audit(system=f"{system}:create").out
    trials = open_run(before).table().num_rows
    assert f"Kept {trials} of {trials} trials, from 20" in again
    assert f"Running: {trials} of {trials} trials" in again
    assert f"{trials} trials in 6 blocks, 0 of them" in (before / "report.html").read_text()

    system.write_text(
        system.read_text().replace("TOLERANCE_M = 0.1, 100, 0.25", "TOLERANCE_M = 0.1, 100, 9.0")
    )
    ended = audit(system=f"{system}:create")
    (after,) = {*(tmp_path / "runs").iterdir()} - {before}
    assert ended.status == 0
    assert (before / "outcomes.parquet").read_bytes() == outcomes
    assert (after / "outcomes.parquet").read_bytes() != outcomes
    assert open_run(after).record.cells != open_run(before).record.cells


def test_a_failed_trial_is_shown_and_the_status_says_so(tmp_path):
    options = {"system": BROKEN, "set": "where=cart/003", "out": tmp_path / "run"}
    for _ in ("at first", "and again"):
        ended = audit(**options)
        assert ended.status == 1
        assert "Traceback" not in ended.out + ended.err
        assert re.search(r"cart/003 .*ZeroDivisionError: the \[cart\] has no wheels", ended.out)
        (place,) = set(re.findall(r"\((\S+failures\S+\.txt)\)", ended.out)[:1])
        assert "has no wheels" in Path(place).read_text()
    effect = open_run(tmp_path / "run").record.effects[0]
    assert (effect.void_pairs, effect.scenes) == (1, 5)
    assert re.search(r"^Shared fault .* 5 +1 ", ended.out, re.MULTILINE), "scenes, then void pairs"


def test_when_every_trial_fails_the_failures_are_shown_and_nothing_is_decided(tmp_path):
    ended = audit(system=BROKEN, set="where=", out=tmp_path / "run", scenes=2)
    said = ended.refused()
    assert "and none ran to its end; in scene 'cart/000': ZeroDivisionError" in said
    assert not (tmp_path / "run" / "record.json").exists()


def test_workers_change_nothing(toy_run, tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert _again(tmp_path / "run", workers=2).status == 0
    for name in ("outcomes.parquet", "record.json"):
        assert (tmp_path / "run" / name).read_bytes() == (toy_run / name).read_bytes()


def test_zero_workers_run_in_this_process(tmp_path, monkeypatch):
    monkeypatch.setattr("faultpath.trials.work.processes.Processes", None)
    assert audit(workers=0, out=tmp_path / "run").status == 0
