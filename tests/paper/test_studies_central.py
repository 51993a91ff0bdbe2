"""The central claim is displayed with its numbers, its state and where it holds."""

import pytest
from faultpath_quadrotor.paper.answers import RUN, Reproduction
from faultpath_quadrotor.paper.central import CLAIM, central, of_page, of_run, state

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
