"""Every test of the command line begins in an empty folder, and leaves `sys.path` as it was."""

import sys
from pathlib import Path

import pytest
from cli_runs import audit


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished audit of the toy, to copy and to damage."""
    folder = tmp_path_factory.mktemp("finished") / "run"
    assert audit(out=folder, scenes=12).status == 0
    return folder
