"""Every example runs from an empty directory."""

from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

QUICK = {
    "own_model.py": ("--episodes", "40", "--epochs", "1"),
    "learned_pendulum.py": ("--windows", "60", "--epochs", "1"),
}
"""Arguments of examples that would take their time without."""
EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_example_runs(example: Path, run: Callable[..., CompletedProcess[str]]) -> None:
    done = run(str(example), *QUICK.get(example.name, ()))
    assert done.returncode == 0, done.stderr
