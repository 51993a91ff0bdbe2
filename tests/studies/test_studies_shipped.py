"""Runs that come with the package: one a platform, found by its name, answered by the command."""

import json
import shutil
from pathlib import Path

import pytest
from toy_runs import EMPTY

from faultpath.errors import UserError
from faultpath.studies import shipped
from faultpath.studies.claims import again, ledger
from faultpath.studies.published import published_claims
from faultpath.studies.run import plan, read_results

FIRST = shipped.shipped_run("first")


@pytest.fixture
def two(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package with a second platform, which has no run, and a third, which has."""
    for name in ("first", "third"):
        shutil.copytree(FIRST, tmp_path / name)
    monkeypatch.setattr(shipped, "RUNS", tmp_path)
    monkeypatch.setattr(shipped, "platforms", lambda: ("first", "second", "third"))
    monkeypatch.setattr(shipped, "default_platform", lambda: "first")
    return tmp_path


def test_the_first_platform_has_its_run_and_is_known() -> None:
    assert "first" in shipped.platforms()
    assert "first" in shipped.shipped()
    _, found = read_results(FIRST)
    assert found.ledger.platform == "first"


def test_every_shipped_run_lies_under_the_platform_that_it_flew_on() -> None:
    folders = {path.name for path in shipped.RUNS.iterdir()}
    assert folders == set(shipped.shipped())
    for platform in folders:
        found = json.loads((shipped.RUNS / platform / "reproduction.json").read_bytes())
        assert found["ledger"].get("platform", "first") == platform


def test_runs_are_found_by_platform_in_the_order_of_freezing(two: Path) -> None:
    assert shipped.shipped() == ("first", "third")
    assert shipped.shipped_run("third") == two / "third"
    assert shipped.shipped_run() == two / "first"


@pytest.mark.parametrize(
    ("platform", "says"),
    [
        ("second", "for platform 'second', only for: first, third. Name one of these, or fly it"),
        ("fourth", "no platform 'fourth': choose from first, second, third."),
    ],
)
def test_a_platform_without_a_run_is_refused(two: Path, platform: str, says: str) -> None:
    with pytest.raises(UserError) as refused:
        shipped.shipped_run(platform)
    assert says in str(refused.value)


def test_a_package_without_runs_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shipped, "RUNS", tmp_path)
    with pytest.raises(UserError, match="only for: none"):
        shipped.shipped_run()


def test_a_run_says_on_which_platform_it_flies() -> None:
    assert plan([], "quick").platform == shipped.default_platform()
    assert plan([], "quick", options={"platform": "first"}).platform == "first"


def test_what_is_answered_anew_keeps_what_it_was_answered_on() -> None:
    old = ledger(EMPTY, "mine", "hash", 7, (0, 1), note="Elsewhere.", platform="third")
    assert again(EMPTY, old) == old


def test_the_first_platform_was_not_matched_to_two_platform_claims() -> None:
    kinds = {claim.id: claim.kind for claim in published_claims()}
    on_first = ledger(EMPTY, "held-out", "hash", 0, (0,), platform="first")
    assert on_first.unmatched == ("C02", "C03")
    assert all(kinds[claim] == "platform" for claim in on_first.unmatched)
    assert ledger(EMPTY, "held-out", "hash", 0, (0,), platform="later").unmatched == ()
