"""A run folder: what it holds, what it refuses, how it heals."""

import json
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from faultpath.core.errors import UserError
from faultpath.core.files.atomic import make_folder
from faultpath.loop import TapCount
from faultpath.run.attempt import Done
from faultpath.run.code import CodeState
from faultpath.run.plan import Plan, Row, SystemSpec, Treatment
from faultpath.run.store.folder import FORMAT, Manifest, RunFolder, read_outcomes
from faultpath.run.store.tables import encode_shard
from faultpath.system.outcome import Outcome, Status


def _manifest(name: str = "a", seed: int = 0, scenes: tuple[str, ...] = ("s0",)) -> Manifest:
    row = Row(
        variant="v", condition="correct", seed=seed, treatment=Treatment(variant="v", seed=seed)
    )
    system = SystemSpec(name="quadrotor")
    plan = Plan(name=name, system=system, library="l", scenes=scenes, rows=(row,))
    return Manifest(faultpath_version="1", code=_code(), library_hash="h", plan=plan)


def _code(**files: str) -> CodeState:
    return CodeState(files={"my.py": "1", **files}, packages={"numpy": "2"}, python="3")


def _outcomes() -> tuple[Outcome, ...]:
    trace = np.arange(12, dtype=np.float32).reshape(4, 3)
    return (
        Outcome("s0", Status.SUCCESS, 2.5, "i", "d", "p", {"offset": -0.125}, 3, 2, None, trace),
        Outcome("s1", Status.FAILED, 0.0, "", "", "", error="ValueError: ä\n"),
        Outcome("s2", Status.CRASH, 1.0, "i", "d", "p", {"return": 5.0}, trace=trace[:0]),
    )


@pytest.fixture
def folder(tmp_path: Path) -> RunFolder:
    folder = RunFolder(tmp_path / "run")
    with folder.open(_manifest(), _unexpected):
        folder.save_shard("k", Done(_outcomes(), TAPS))
    return folder


def _unexpected(text: str) -> None:
    raise AssertionError(text)


SCENES = ("s0", "s1", "s2")
TAPS = (TapCount("mass", "planner.thrust", 36, 9, 8), TapCount("mass", "observer.model", 36, 0, 0))


def test_a_run_that_was_killed_at_its_first_write_goes_on(tmp_path, monkeypatch):
    folder = RunFolder(tmp_path / "run")

    def killed(path: Path) -> None:
        make_folder(path)
        if path.parent == folder.path:
            raise KeyboardInterrupt

    monkeypatch.setattr("faultpath.run.store.folder.make_folder", killed)
    with pytest.raises(KeyboardInterrupt), folder.open(_manifest(), _unexpected):
        pass
    monkeypatch.undo()
    with folder.open(_manifest(), _unexpected):
        assert folder.list_shards() == {}


def test_a_shard_reads_back(folder):
    found = folder.load_shard("k", SCENES, _unexpected)
    assert found is not None
    assert found.taps == TAPS
    for one, two in zip(found.outcomes, _outcomes(), strict=True):
        for name in Outcome.__dataclass_fields__:
            np.testing.assert_equal(getattr(one, name), getattr(two, name))
    assert found.outcomes[0].trace is not None
    assert found.outcomes[0].trace.dtype == np.float32
    assert folder.load_shard("another", SCENES, _unexpected) is None


def test_an_edited_shard_is_named_and_removed(folder):
    """What is cut or flipped, tests of disturbed runs spoil."""
    (shard,) = folder.shards.iterdir()
    edited = tuple(replace(outcome, time_s=9.0) for outcome in _outcomes())
    shard.write_bytes(encode_shard("k", Done(edited, TAPS)))
    notices: list[str] = []
    assert folder.load_shard("k", SCENES, notices.append) is None
    (notice,) = notices
    assert str(shard) in notice
    assert not shard.exists()


def test_of_two_shards_of_a_block_the_one_that_failed_less_is_taken(folder):
    (before,) = folder.shards.iterdir()
    data = before.read_bytes()
    hashes = dict.fromkeys(("initial_hash", "disturbance_hash", "planner_noise_hash"), "none")
    ended = {"status": Status.CRASH, "time_s": 1.0, **hashes}
    sound = Done(tuple(replace(outcome, **ended) for outcome in _outcomes()), TAPS)
    folder.save_shard("k", sound)
    (after,) = folder.shards.iterdir()
    assert after != before
    before.write_bytes(data)  # as a process leaves it that was killed before it tidied up
    found = RunFolder(folder.path).load_shard("k", SCENES, _unexpected)
    assert found is not None
    assert not any(outcome.failed for outcome in found.outcomes)


def test_a_shard_of_another_unit_or_of_other_scenes_is_not_taken(folder):
    (shard,) = folder.shards.iterdir()
    digest = shard.stem.partition("-")[2]
    shard.with_name(f"other-{digest}.parquet").write_bytes(shard.read_bytes())
    folder = RunFolder(folder.path)
    notices: list[str] = []
    assert folder.load_shard("other", SCENES, notices.append) is None
    assert folder.load_shard("k", SCENES[:2], notices.append) is None
    assert ["another key" in notices[0], "other scenes" in notices[1]] == [True, True]


@pytest.mark.parametrize(
    ("other", "what"),
    [
        (_manifest(name="b"), "another question"),
        (_manifest(seed=1), "another set of variants, faults or seeds"),
        (_manifest().model_copy(update={"code": _code(helper="2")}), r"other code.*: helper\)"),
        (_manifest().model_copy(update={"library_hash": "g"}), "another state of the library"),
        (_manifest().model_copy(update={"faultpath_version": "2"}), "version of faultpath"),
    ],
)
def test_another_plan_is_refused(folder, other, what):
    before = folder.manifest.read_bytes()
    with pytest.raises(UserError, match=what), folder.open(other, _unexpected):
        pass
    assert folder.manifest.read_bytes() == before


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", r"manifest\.json"),
        ("[]", r"manifest\.json"),
        (json.dumps({"format": FORMAT}), r"manifest\.json"),
        (json.dumps({"format": FORMAT + 1}), f"format {FORMAT + 1}"),
    ],
)
def test_a_damaged_manifest_and_one_of_another_format_are_refused(folder, text, says):
    folder.manifest.write_text(text)
    with pytest.raises(UserError, match=says), folder.open(_manifest(), _unexpected):
        pass


def test_a_folder_that_cannot_be_made_is_refused():
    folder = RunFolder(Path("/proc/faultpath-run"))
    with (
        pytest.raises(UserError, match="/proc/faultpath-run"),
        folder.open(_manifest(), _unexpected),
    ):
        pass


def test_a_pipe_in_place_of_a_traceback_is_not_waited_for(folder):
    assert folder.load_failure("k") == ""
    os.mkfifo(folder.failures / "k.txt")
    with pytest.raises(OSError, match="it is a pipe"):
        folder.load_failure("k")


def test_tables_that_cannot_be_read_say_so(folder, tmp_path):
    with pytest.raises(UserError, match=r"outcomes\.parquet"):
        read_outcomes(folder.path / "outcomes.parquet")
    (tmp_path / "outcomes.parquet").write_bytes(b"PAR1 nothing PAR1")
    with pytest.raises(UserError, match="damaged"):
        read_outcomes(tmp_path / "outcomes.parquet")
