"""The facts that the paper states are all accounted for, and lie where the list says."""

from itertools import groupby
from pathlib import Path

import pytest
from faultpath_paper.facts import SECTIONS, Fact, facts, groups

ROOT = Path(__file__).resolve().parents[2]
PLACES = {"faultpath": ROOT / "src", "faultpath_paper": ROOT / "paper" / "src"}
PACKAGE = ROOT / "quadrotor" / "src" / "faultpath_quadrotor"


def test_every_fact_is_there_once_and_few_are_otherwise() -> None:
    assert sorted(fact.number for fact in facts()) == list(range(1, 115))
    assert sum(fact.state == "otherwise" for fact in facts()) <= 5
    sections = [group.section for group in groups()]
    assert [key for key, _ in groupby(sections)] == list(SECTIONS)
    assert [fact for section in SECTIONS for fact in facts(section)] == [*facts()]


@pytest.mark.parametrize("fact", facts(), ids=lambda fact: str(fact.number))
def test_a_fact_says_what_is_done_and_where(fact: Fact) -> None:
    assert bool(fact.ours) == (fact.state != "as written")
    assert fact.at
    for place in fact.at:
        file, _, name = place.partition(" ")
        path = PLACES.get(file.partition("/")[0], PACKAGE) / file
        assert path.is_file(), place
        assert name, place
        assert name in path.read_text("utf-8"), place
