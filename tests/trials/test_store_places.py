"""What a file may take the place of: another file, and nothing else."""

import os
import socket
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

from faultpath.core.errors import UserError
from faultpath.trials.store import atomic
from faultpath.trials.store.atomic import write_text


def _pipe(path: Path) -> None:
    os.mkfifo(path)


def _socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as endpoint, pytest.MonkeyPatch.context() as patch:
        patch.chdir(path.parent)  # the path of a socket may be a hundred bytes long
        endpoint.bind(path.name)


def _device(path: Path) -> None:
    try:
        os.mknod(path, 0o600 | stat.S_IFCHR, os.makedev(1, 3))
    except PermissionError:
        pytest.skip("only root makes devices")


def _folder(path: Path) -> None:
    path.mkdir()


THINGS = {"a pipe": _pipe, "a socket": _socket, "a device": _device, "a folder": _folder}


@pytest.mark.parametrize(("what", "make"), THINGS.items(), ids=THINGS)
def test_what_is_no_file_stays_as_it_is(what: str, make: Callable[[Path], None], tmp_path: Path):
    path = tmp_path / "place"
    make(path)
    before = path.lstat()
    with pytest.raises(UserError, match=f"{path}.*it is {what}"):
        write_text(path, "new")
    after = path.lstat()
    assert (after.st_ino, after.st_mode) == (before.st_ino, before.st_mode)
    assert os.listdir(tmp_path) == ["place"]


@pytest.mark.parametrize(("what", "make"), THINGS.items(), ids=THINGS)
def test_nor_does_a_link_lead_there(what: str, make: Callable[[Path], None], tmp_path: Path):
    make(tmp_path / "place")
    before = (tmp_path / "place").lstat()
    (tmp_path / "link").symlink_to("place")
    with pytest.raises(UserError, match=f"it is {what}"):
        write_text(tmp_path / "link", "new")
    assert (tmp_path / "place").lstat() == before
    assert (tmp_path / "link").is_symlink()


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
    assert not target.is_symlink()
    assert (tmp_path / "first").is_symlink()
    assert (tmp_path / "second").is_symlink()
    assert os.listdir(tmp_path / "deep") == ["file"]


def test_links_in_a_circle_are_refused(tmp_path: Path):
    (tmp_path / "one").symlink_to("two")
    (tmp_path / "two").symlink_to("one")
    with pytest.raises(UserError, match="levels of symbolic links"):
        write_text(tmp_path / "one", "new")


def test_a_link_out_of_a_run_folder_is_not_followed(tmp_path: Path):
    """A run folder may come from anybody, and the names of its files are ours."""
    mine = tmp_path / "mine"
    mine.write_text("mine")
    run = tmp_path / "run"
    run.mkdir()
    (run / "out").symlink_to(mine)
    (run / "in").symlink_to("inside")
    for place, says in ((run / "out", "link out of"), (run / "in", None)):
        if says is None:
            atomic.write(place, b"new", inside=run)
        else:
            with pytest.raises(UserError, match=says):
                write_text(place, "new", inside=run)
    assert mine.read_text() == "mine"
    assert (run / "inside").read_text() == "new"


def test_a_path_with_a_null_character_is_a_mistake(tmp_path: Path):
    with pytest.raises(UserError, match="null"):
        write_text(tmp_path / "a\0b", "new")
