"""Every run of the tests tries the same inputs; `make fuzz` explores with random ones."""

import os
import secrets
import signal
import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest
from engine_alone import EngineAlone
from hypothesis import settings

settings.register_profile("fixed", derandomize=True, database=None, deadline=None)
settings.register_profile("explore", derandomize=False, max_examples=500, deadline=None)
settings.load_profile("fixed")

sys.path.insert(0, str(Path(__file__).with_name("toys")))


# A shell's background starts its commands deaf to Ctrl-C, and what they start would be deaf too.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--fuzz-seed", default="1", help="Seed of the fuzz tests, a number or `random`."
    )
    parser.addoption("--fuzz-whole", action="store_true", help="Try all odd inputs, not a few.")
    parser.addoption("--approve", action="store_true", help="Write texts that tests compare anew.")


def pytest_configure(config: pytest.Config) -> None:
    if not find_spec("torch"):
        config.pluginmanager.register(EngineAlone(), "engine-alone")
    elif find_spec("faultpath_quadrotor"):
        import_module("faultpath_quadrotor")  # configures torch before any test uses it


@pytest.fixture(autouse=True, scope="session")
def _flushed_later() -> Iterator[None]:
    """Let the disk take files in its own time, for which runs of many small files would wait."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda descriptor: None)
        yield


@pytest.fixture(autouse=True)
def _own_path(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave no folders of systems to other tests."""
    monkeypatch.setattr(sys, "path", list(sys.path))


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Begin in an empty folder."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def fuzz_seed(request: pytest.FixtureRequest) -> int:
    """The seed of what a fuzz test tries; a failing test names it."""
    seed = request.config.getoption("--fuzz-seed")
    return secrets.randbelow(10**9) if seed == "random" else int(seed)


@pytest.fixture
def without_pages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let audits write no page, for tests that look at none: it takes longer than small audits."""
    monkeypatch.setattr("faultpath.api.runs.write_report", lambda *_: [])


@pytest.fixture
def approved(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Compare a text with the approved one of its name, in a folder beside the test's file.

    `--approve` writes it anew; read the difference before it is committed.
    """
    folder = request.path.parent / "approved" / request.path.stem.removeprefix("test_")

    def check(name: str, text: str) -> None:
        path = folder / f"{name}.txt"
        if request.config.getoption("--approve"):
            folder.mkdir(parents=True, exist_ok=True)
            path.write_text(f"{text}\n", "utf-8")
        assert text == path.read_text("utf-8").removesuffix("\n")

    return check


@pytest.fixture(scope="module")
def selection_held_out() -> Iterator[None]:
    """Selection scenes in the place of the held-out ones, which are run once and not by tests."""
    from faultpath_quadrotor.scenes import library

    real = library.frozen_file
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            library, "frozen_file", lambda name: real("selection" if name == "held-out" else name)
        )
        yield
