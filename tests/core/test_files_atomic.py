"""Files are whole or absent, replace files alone, and one process at a time writes them."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from no_files import THINGS

from faultpath.core.errors import UserError
from faultpath.core.files import atomic
from faultpath.core.files.atomic import locked, write_text


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    path = tmp_path / "file"
    atomic.write(path, b"old")

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(UserError, match="No space left"):
        write_text(path, "new")
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["file"]


def test_a_file_gets_the_permissions_of_any_other(tmp_path):
    (tmp_path / "plain").touch()
    atomic.write(tmp_path / "atomic", b"")
    modes = {(tmp_path / name).stat().st_mode for name in ("plain", "atomic")}
    assert len(modes) == 1


def test_the_lock_of_a_killed_process_is_free(tmp_path):
    code = (
        "import sys, time; from pathlib import Path\n"
        "from faultpath.core.files.atomic import locked\n"
        "with locked(Path(sys.argv[1]), print):\n    print('held', flush=True); time.sleep(60)"
    )
    command = [sys.executable, "-c", code, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "held\n"
        notices: list[str] = []

        def kill(text: str) -> None:
            notices.append(text)
            process.kill()

        with locked(tmp_path, kill):
            assert process.wait() < 0
    assert f"(id {process.pid}) works in {tmp_path}" in notices[0]


@pytest.mark.parametrize("linked", [False, True], ids=["itself", "linked"])
@pytest.mark.parametrize("what", THINGS)
def test_what_is_no_file_stays_as_it_is(what: str, linked: bool, tmp_path: Path):
    place, link = tmp_path / "place", tmp_path / "link"
    THINGS[what](place)
    before = place.lstat()
    if linked:
        link.symlink_to("place")
    names = sorted(os.listdir(tmp_path))
    with pytest.raises(UserError, match=f"it is {what}"):
        write_text(link if linked else place, "new")
    after = place.lstat()
    assert (after.st_ino, after.st_mode) == (before.st_ino, before.st_mode)
    assert sorted(os.listdir(tmp_path)) == names
    assert link.is_symlink() == linked


@pytest.mark.parametrize("there", [True, False], ids=["to a file", "to nothing yet"])
def test_a_link_is_followed_and_kept(there: bool, tmp_path: Path):
    (tmp_path / "deep").mkdir()
    target = tmp_path / "deep" / "file"
    if there:
        target.write_text("old")
    (tmp_path / "second").symlink_to("deep/file")
    (tmp_path / "first").symlink_to(tmp_path / "second")
    write_text(tmp_path / "first", "new")
    assert target.read_text() == "new"
    assert [path.is_symlink() for path in (target, tmp_path / "first", tmp_path / "second")] == [
        False,
        True,
        True,
    ]
    assert os.listdir(tmp_path / "deep") == ["file"]


def test_a_path_that_leads_nowhere_is_a_mistake(tmp_path: Path):
    (tmp_path / "one").symlink_to("two")
    (tmp_path / "two").symlink_to("one")
    with pytest.raises(UserError, match="levels of symbolic links"):
        write_text(tmp_path / "one", "new")
    with pytest.raises(UserError, match="null"):
        write_text(tmp_path / "a\0b", "new")


def test_a_link_out_of_a_run_folder_is_not_followed(tmp_path: Path):
    """A run folder may come from anybody, and the names of its files are ours."""
    mine, run = tmp_path / "mine", tmp_path / "run"
    mine.write_text("mine")
    run.mkdir()
    (run / "out").symlink_to(mine)
    (run / "in").symlink_to("inside")
    with pytest.raises(UserError, match="link out of"):
        write_text(run / "out", "new", inside=run)
    write_text(run / "in", "new", inside=run)
    assert mine.read_text() == "mine"
    assert (run / "inside").read_text() == "new"
