"""The tests try the same inputs every time; exploring is a command of its own."""

from pathlib import Path

import pytest
from hypothesis import settings


def test_hypothesis_draws_the_same_examples_every_time(request: pytest.FixtureRequest) -> None:
    exploring = request.config.getoption("--hypothesis-profile") == "explore"
    assert settings.default.derandomize is not exploring
    assert settings.get_profile("fixed").derandomize
    assert settings.get_profile("fixed").database is None


def test_exploring_with_random_seeds_is_a_command(root: Path) -> None:
    text = (root / "Makefile").read_text()
    recipe = text[text.index("\nfuzz:") :].partition("\n\n")[0]
    assert "--hypothesis-profile=explore" in recipe
    assert "--fuzz-seed=$(SEED)" in recipe
    assert "SEED ?= random" in text
    settings.get_profile("explore")
    assert not settings.get_profile("explore").derandomize
