"""Every example runs from an empty directory."""

from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_example_runs(example: Path, run: Callable[..., CompletedProcess[str]]) -> None:
    done = run(str(example))
    assert done.returncode == 0, done.stderr
