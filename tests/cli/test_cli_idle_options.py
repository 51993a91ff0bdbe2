"""An option that would do nothing is refused: whoever gives it believes that it did something."""

import pytest
from cli_runs import audit, faultpath

IDLE = {
    "judged": (["reproduce", "--judge", "--profile", "x"], "--profile would do", "--judge"),
    "judged pages": (
        ["reproduce", "table-4", "--judge", "--workers", "2"],
        "--pages and --workers would do nothing",
        "--judge",
    ),
    "page of one run": (["report", ".", "--out", "a.html"], "--out takes", "two or more"),
    "listed models": (["train", "quadrotor", "--list", "--ship"], "--ship would", "--list"),
    "listed seeds": (["train", "quadrotor", "--list", "--seed", "1"], "--seed would", "--list"),
    "listed names": (["train", "quadrotor", "gru", "--list"], "--names would", "--list"),
    "listed places": (["train", "quadrotor", "--list", "--out", "x"], "--out would", "--list"),
}


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(("arguments", "says", "needed"), IDLE.values(), ids=IDLE)
def test_an_option_that_would_do_nothing(arguments, says, needed, tmp_path):
    sentence = faultpath(*arguments).refused()
    assert says in sentence
    assert needed in sentence
    assert list(tmp_path.iterdir()) == []


def test_an_option_given_by_its_name_and_by_set():
    asked = audit("--wind", "L1", "--set", "wind=L2", system="quadrotor")
    assert "'wind' twice" in asked.refused()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["train", "quadrotor", "--seed", str(2**64)], "9223372036854775807"),
        (["reproduce", "x" * 5000], "too long"),
        (["reproduce", "\udcff"], "UTF-8"),
        (["trace", "a\x1b[31mb.py:create"], "\\x1b[31m"),
        (["report", "a\u2028b"], "\\u2028"),
    ],
    ids=lambda value: str(value)[:20],
)
def test_numbers_and_names_beyond_all_bounds(arguments, says, tmp_path):
    sentence = faultpath(*arguments).refused()
    assert says in sentence
    assert len(sentence) < 800
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("limit", "workers", "says"),
    [
        ("0", 1, "the time limit is 0 s"),
        ("nan", 1, "the time limit is nan s"),
        ("5", 0, "a time limit needs worker processes"),
    ],
)
def test_a_time_limit_that_cannot_be_kept(limit, workers, says, tmp_path):
    """Refused where trials run; none does."""
    sentence = faultpath(
        "reproduce", "table-4", "--time-limit", limit, "--workers", workers
    ).refused()
    assert says in sentence


@pytest.mark.parametrize("seeds", [str(2**63), "-1", "9" * 4000, "٣", "1_0"])
def test_seeds_that_no_table_holds(seeds):
    assert "--seeds" in audit(seeds=seeds).refused()
