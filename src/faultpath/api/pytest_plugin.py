"""The fixture `faultpath` for pytest, found by its entry point: audits and judgements in tests."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from faultpath.api.runs import Run


class Audits:
    """`audit` and `judge` as from Python; by default a run goes into the test's own folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._count = 0

    def audit(self, system: Any, **arguments: Any) -> "Run":
        """Return `faultpath.audit(system, ...)`."""
        import faultpath

        return faultpath.audit(system, **self._arguments(arguments))

    def judge(self, results: Any, **arguments: Any) -> "Run":
        """Return `faultpath.judge(results, ...)`."""
        import faultpath

        return faultpath.judge(results, **self._arguments(arguments))

    def _arguments(self, arguments: dict[str, Any]) -> dict[str, Any]:
        self._count += 1
        place = self._folder / f"faultpath-{self._count}"
        return {"folder": place, "progress": False, **arguments}


@pytest.fixture
def faultpath(tmp_path: Path) -> Audits:
    """Audit a repair, or judge trials that other tools ran, and assert the result."""
    return Audits(tmp_path)
