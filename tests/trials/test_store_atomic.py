"""Files are whole or absent, and one process at a time writes them."""

import os
import subprocess
import sys

import pytest

from faultpath.core.errors import UserError
from faultpath.trials.store import atomic
from faultpath.trials.store.atomic import locked, write_text


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
        "from faultpath.trials.store.atomic import locked\n"
        "with locked(Path(sys.argv[1]), print):\n    print('held', flush=True); time.sleep(60)"
    )
    command = [sys.executable, "-c", code, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "held\n"
        told: list[str] = []

        def kill(text: str) -> None:
            told.append(text)
            process.kill()

        with locked(tmp_path, kill):
            assert process.wait() < 0
    assert f"(id {process.pid}) works in {tmp_path}" in told[0]


def test_a_lock_is_free_after_use(tmp_path):
    told: list[str] = []
    for _ in range(2):
        with locked(tmp_path, told.append):
            pass
    assert not told
