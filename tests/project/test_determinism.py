"""The tests try the same inputs every time; exploring is a command of its own."""

import pytest
from hypothesis import settings


def test_hypothesis_draws_the_same_examples_every_time(request: pytest.FixtureRequest) -> None:
    exploring = request.config.getoption("--hypothesis-profile") == "explore"
    assert settings.default.derandomize is not exploring
    assert settings.get_profile("fixed").derandomize
    assert settings.get_profile("fixed").database is None
