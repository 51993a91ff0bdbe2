"""Skips tests that need more than the engine, where torch is not installed.

Such an environment is that of `pip install -e ".[test]"`, or of a Python for which torch has no
build. pytest lists each skipped test with the package that it needs. With torch, a missing package
is an error.
"""

import inspect
import re
from collections.abc import Generator
from importlib.util import find_spec
from typing import Any

import pytest

OPTIONAL = (
    "torch",
    "faultpath_quadrotor",
    "faultpath_paper",
    "ray",
    "playwright",
    "grimp",
    "jsonschema",
    "pyperf",
    "hatchling",
)
REPORTED = re.compile(r"(?:No module named|needs the package|'lacks',) '(\w+)")
"""A missing package in the output of a process, which a failed assertion shows."""
QUADROTOR = re.compile(r"quadrotor\b(?!-)|\b(reproduce|train)\b")
"""Names by which a test's code or parameters use the quadrotor in a command, without an import."""


class EngineAlone:
    """Plugin that skips these tests."""

    def __init__(self) -> None:
        self.missing = [name for name in OPTIONAL if find_spec(name) is None]

    def _imported(self, error: BaseException | None) -> str | None:
        """Return the missing package that caused an error."""
        while error is not None:
            if isinstance(error, ModuleNotFoundError):
                top = (error.name or "").partition(".")[0]
                return top if top in self.missing else None
            if (named := REPORTED.search(str(error))) and named[1] in self.missing:
                return named[1]
            error = error.__cause__ or error.__context__
        return None

    @pytest.hookimpl(wrapper=True)
    def pytest_make_collect_report(self, collector: pytest.Collector) -> Generator[None, Any, Any]:
        """Skip a file, or a folder, that imports a missing package."""
        report = yield
        if report.failed and (needed := self._imported(report.call.excinfo.value)):
            report.outcome = "skipped"
            report.longrepr = (str(collector.path), None, f"needs {needed}")
        return report

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Skip tests that use the quadrotor by its name or its commands."""
        if "faultpath_quadrotor" not in self.missing:
            return
        for item in items:
            case = getattr(item, "callspec", None)
            source = inspect.getsource(getattr(item, "function", type(item)))
            source = source[source.find("def ") :]  # without decorators, which list all cases
            source += (
                "" if case is None else f"\n{case.id} {list(map(_shown, case.params.values()))}"
            )
            if QUADROTOR.search(source):
                item.add_marker(pytest.mark.skip(reason="needs faultpath_quadrotor"))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self) -> Generator[None, Any, Any]:
        """Skip a test whose fixture imports a missing package."""
        return (yield from self._skipping())

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self) -> Generator[None, Any, Any]:
        """Skip a test that needs a missing package as it runs, in this process or another."""
        return (yield from self._skipping())

    def _skipping(self) -> Generator[None, Any, Any]:
        try:
            return (yield)
        except Exception as error:
            if needed := self._imported(error):
                pytest.skip(f"needs {needed}")
            raise


def _shown(value: object) -> str:
    try:
        return repr(value)
    except Exception:  # values of tests may refuse to be shown
        return ""
