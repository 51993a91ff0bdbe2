"""What of the tests runs where the engine is alone, as under Pythons for which torch has no build.

With `--engine-alone`, a test that needs a package which is missing and which the engine can do
without is skipped; pytest lists each with the package. Else a missing package is a mistake.
"""

import inspect
import re
from collections.abc import Generator
from importlib.util import find_spec
from typing import Any

import pytest

OPTIONAL = ("torch", "faultpath_quadrotor", "faultpath_paper", "ray", "playwright")
QUADROTOR = re.compile(r"quadrotor\b(?!-)|\b(reproduce|train)\b")
"""What a test that asks for the quadrotor says in its code or its parameters: where commands and
processes name it, no import does."""


class EngineAlone:
    """The plugin behind `--engine-alone`."""

    def __init__(self) -> None:
        self.missing = [name for name in OPTIONAL if find_spec(name) is None]

    def _imported(self, error: BaseException | None) -> str | None:
        """Return the missing package that an error comes of."""
        while error is not None:
            if isinstance(error, ModuleNotFoundError):
                top = (error.name or "").partition(".")[0]
                return top if top in self.missing else None
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
        """Skip the tests that ask for the quadrotor by its name or its verbs."""
        if "faultpath_quadrotor" not in self.missing:
            return
        for item in items:
            case = getattr(item, "callspec", None)
            source = inspect.getsource(getattr(item, "function", type(item)))
            source = source[source.find("def ") :]  # the cases of others stand above it
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
        """Skip a test that imports a missing package as it runs."""
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
