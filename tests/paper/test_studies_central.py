"""The central claim has its numbers, state and place; the ledger in short leaves nothing out."""

import re

import pytest
from faultpath_quadrotor.paper.answers import RUN, Ledger, Reproduction, shipped_ledger
from faultpath_quadrotor.paper.cells import published_claims
from faultpath_quadrotor.paper.central import CLAIM, central, of_page, of_run, state
from faultpath_quadrotor.paper.claims import SUBJECTS
from faultpath_quadrotor.paper.report.short import apart, by_kind, by_subject

from faultpath.decisions.tables import line


@pytest.fixture(scope="module")
def found() -> Reproduction:
    return Reproduction.model_validate_json((RUN / "reproduction.json").read_bytes())


def test_it_says_where_the_ranking_is_decided_to_reverse() -> None:
    answers = {"At a": "decided", "At b": "not decided", "At c": "decided"}
    lines = [line(place, "+1", "-1", said) for place, said in answers.items()]
    notes = central(lines).notes
    assert notes[0] == "The ranking reverses at a; at c."
    assert central([]).notes[0] == "Nowhere is it decided."


def test_a_run_tells_the_claim_by_the_papers_rules(found: Reproduction) -> None:
    told = of_run(found, "Here")
    assert told is not None
    for entry in told.entries[:-1]:
        low, high = entry.text.replace("−", "-").split("[")[1].rstrip("]").split(", ")
        assert entry.detected == (float(low) > 0 or float(high) < 0)
    assert told.entries[-1].text == "not decided"
    claim = next(each for each in found.ledger.claims if each.id == CLAIM)
    assert f"{CLAIM} is {claim.verdict} on this run" in state(found.ledger)


def test_a_page_tells_of_its_own_run_unless_it_is_quick(found: Reproduction) -> None:
    told = of_page(found)
    assert told
    assert told[1].lines[0].label.startswith("In this run")
    quick = of_page(found.model_copy(update={"profile": "quick"}))
    assert quick
    assert "decides nothing" in quick[0]
    assert not any(each.label.startswith("In this run") for each in quick[1].lines)
    none = found.ledger.model_copy(update={"claims": found.ledger.claims[:3]})
    assert of_page(found.model_copy(update={"ledger": none})) is None


@pytest.fixture(scope="module")
def ledger() -> Ledger:
    return shipped_ledger()


def test_every_claim_stands_once_under_its_kind_and_answer(ledger: Ledger) -> None:
    lines = by_kind(ledger).lines
    told = [name for each in lines for e in each.entries for name in re.findall(r"C\d\d", e.text)]
    assert sorted(told) == [claim.id for claim in ledger.claims]


def test_every_claim_has_one_subject_and_its_figures_add_up(ledger: Ledger) -> None:
    every = [claim for claims in SUBJECTS.values() for claim in claims]
    assert sorted(every) == [claim.id for claim in published_claims()]
    *subjects, last = (
        [int(entry.text) for entry in each.entries] for each in by_subject(ledger).lines
    )
    assert [sum(column) for column in zip(*subjects, strict=True)] == last
    assert last[0] >= sum(last[1:]) > 0


def test_what_did_not_come_out_is_told_by_the_part_that_decides(ledger: Ledger) -> None:
    told = dict(apart(ledger))
    assert [name[:3] for name in told] == [c.id for c in ledger.claims if c.verdict != "confirmed"]
    assert all(":" in said for said in told.values())
