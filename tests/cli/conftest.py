"""Every test of the command line begins in an empty folder."""

from pathlib import Path

import pytest
from cli_runs import audit


@pytest.fixture(autouse=True)
def _elsewhere(elsewhere: None) -> None:
    """Hold for all of them."""


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished audit of the toy, to copy and to damage."""
    folder = tmp_path_factory.mktemp("finished") / "run"
    assert audit(out=folder, scenes=12).status == 0
    return folder
