"""Every run of the tests tries the same inputs; `make fuzz` explores with random ones."""

import secrets
import signal
from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec

import pytest
from engine_alone import EngineAlone
from hypothesis import settings

settings.register_profile("fixed", derandomize=True, database=None, deadline=None)
settings.register_profile("explore", derandomize=False, max_examples=500, deadline=None)
settings.load_profile("fixed")


# A shell's background starts its commands deaf to Ctrl-C, and what they start would be deaf too.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--fuzz-seed", default="1", help="Seed of the fuzz tests, a number or `random`."
    )
    parser.addoption("--fuzz-whole", action="store_true", help="Try all odd inputs, not a few.")
    parser.addoption(
        "--engine-alone", action="store_true", help="Leave out what needs torch or the quadrotor."
    )


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("--engine-alone"):
        config.pluginmanager.register(EngineAlone(), "engine-alone")
    elif find_spec("faultpath_quadrotor") and find_spec("torch"):
        import_module("faultpath_quadrotor")  # tells torch what to use, before a test computes


@pytest.fixture
def fuzz_seed(request: pytest.FixtureRequest) -> int:
    """The seed of what a fuzz test tries; a failing test names it."""
    given = request.config.getoption("--fuzz-seed")
    return secrets.randbelow(10**9) if given == "random" else int(given)


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
