"""What the tests about the project itself share."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT), str(ROOT / "tools")]

Run = Callable[..., CompletedProcess[str]]


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def tracked(root: Path) -> list[Path]:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=root, capture_output=True, text=True)
    if listed.returncode != 0:
        pytest.skip("not a git checkout: there is no list of the project's files")
    paths = (root / name for name in listed.stdout.split("\0") if name)
    return [path for path in paths if path.is_file()]


@pytest.fixture
def workspace(tmp_path: Path, root: Path) -> Path:
    """An empty directory that commands run in, with the examples at hand."""
    (tmp_path / "examples").symlink_to(root / "examples")
    return tmp_path


@pytest.fixture
def run(workspace: Path) -> Run:
    """Run Python, or a shell line, in the workspace with this environment's programs first."""
    environment = dict(
        os.environ,
        PATH=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]),
        COLUMNS="100",
        NO_COLOR="1",
        TERM="dumb",
        MPLBACKEND="agg",
    )

    def call(*command: str, shell: bool = False) -> CompletedProcess[str]:
        return subprocess.run(
            command[0] if shell else [sys.executable, *command],
            shell=shell,
            cwd=workspace,
            env=environment,
            capture_output=True,
            text=True,
            timeout=600,
        )

    return call
