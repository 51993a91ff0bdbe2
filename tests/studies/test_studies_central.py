"""The central claim is told with its numbers, its state and where it holds."""

import json
from pathlib import Path

import pytest

from faultpath.record import DecisionRecord, Reproduction
from faultpath.studies.central import CLAIM, ELSEWHERE, central, decided, of_page, of_run, state
from faultpath.studies.shipped import shipped_run
from faultpath.tables import Line, Table, line

NEW_SCENES = Path(__file__).resolve().parents[2] / "docs" / "reference" / "new-scenes"


def run(platform: str) -> Reproduction:
    text = (shipped_run(platform) / "reproduction.json").read_bytes()
    return Reproduction.model_validate_json(text)


def when(*answers: str) -> list[str]:
    lines = [
        line(f"At {place}", "+1", "-1", said) for place, said in zip("abcd", answers, strict=False)
    ]
    return list(central(lines).notes[:-1])


@pytest.mark.parametrize(
    ("answers", "said"),
    [
        ((), []),
        (("decided",), ["The reversal is decided at a."]),
        (("not decided",), ["The reversal is not decided at a."]),
        (
            ("not decided", "decided"),
            ["The reversal is decided at b.", "The reversal is not decided at a."],
        ),
        (
            ("decided", "decided", "not decided", "not decided"),
            ["The reversal is decided at a; at b.", "The reversal is not decided at c; at d."],
        ),
    ],
)
def test_it_says_where_the_reversal_is_decided_and_where_not(
    answers: tuple[str, ...], said: list[str]
) -> None:
    assert when(*answers) == said


def test_a_run_tells_the_claim_by_the_papers_rules() -> None:
    matched, first = (of_run(run(name), "Here") for name in ("matched", "first"))
    assert matched
    assert first
    assert [each.detected for each in matched.entries] == [True, False, False]
    assert (matched.entries[-1].text, first.entries[-1].text) == ("not decided", "decided")
    claim = next(each for each in run("matched").ledger.claims if each.id == CLAIM)
    assert f"{CLAIM} is {claim.verdict} on this run" in state(run("matched").ledger)


def test_what_was_decided_besides_is_what_the_records_say() -> None:
    lines = Table.model_validate_json(ELSEWHERE.read_bytes()).lines
    for folder in sorted(NEW_SCENES.iterdir()):
        held = json.loads((folder / "decided.json").read_bytes())
        record = DecisionRecord.model_validate(held)
        assert decided(record, "").entries in [each.entries for each in lines]
        turns = {change.isolated: change.turn for change in record.changes}
        assert (decided(record, "").entries[-1].text == "decided") == (
            turns["reconstruction"] == "reversal"
        )


def test_a_page_tells_of_its_own_run_unless_it_is_quick() -> None:
    found = run("matched")
    told = of_page(found)
    assert told
    assert told[1].lines[0].label.startswith("In this run")
    assert not any(each.label.endswith("platform matched") for each in told[1].lines)
    quick = of_page(found.model_copy(update={"profile": "quick"}))
    assert quick
    assert "decides nothing" in quick[0]
    assert not any(each.label.startswith("In this run") for each in quick[1].lines)
    other = found.ledger.model_copy(update={"note": "Another library takes the place."})
    alone = of_page(found.model_copy(update={"ledger": other}))
    assert alone
    assert [each.label for each in alone[1].lines[1:]] == ["The paper"]
    none = found.ledger.model_copy(update={"claims": found.ledger.claims[:3]})
    assert of_page(found.model_copy(update={"ledger": none})) is None
    assert isinstance(told[1].lines[-1], Line)
