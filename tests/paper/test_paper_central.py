"""The central claim has its numbers, state and place; kinds of claims are counted apart."""

import pytest
from faultpath_paper import central
from faultpath_paper.answers import RUN, Ledger, Reproduction, shipped_ledger
from faultpath_paper.report.words import headline

from faultpath.stats.estimate import Sign


@pytest.fixture(scope="module")
def found() -> Reproduction:
    return Reproduction.model_validate_json((RUN / "reproduction.json").read_bytes())


SIGNS = {-1: "−5.0 [−9.0, −1.0]", 0: "+1.0 [−3.0, 5.0]", 1: "+6.0 [2.0, 10.0]"}


def case(isolated: Sign, shared: Sign, *, reversal: bool = False) -> central.Case:
    """Return a run that detected effects with these signs."""
    one, two = (central.PrintedEffect(text=SIGNS[sign], sign=sign) for sign in (isolated, shared))
    return central.Case(place="4 scenes here", isolated=one, shared=two, reversal=reversal)


def test_the_answer_is_a_reversal_only_where_a_run_decides_one() -> None:
    fall = {"change": central.PrintedEffect(text="−9.0", sign=-1)}
    for signs in ((0, 0), (1, 0), (0, -1), (1, -1), (-1, 1)):
        assert "did not reproduce" in central.answer([case(*signs)])
    for signs in ((0, 0), (0, -1), (1, 1), (-1, -1)):
        assert "did not reproduce" in central.answer([case(*signs).model_copy(update=fall)])
    one = case(1, -1, reversal=True).model_copy(update=fall)
    gone = case(1, 0).model_copy(update=fall)
    for cases, shown in (
        ([gone], "a loss there, as in the paper, is not shown"),
        ([one], "a loss there, as in the paper, is shown"),
        ([one, gone], "in 1 of our 2 sets of scenes the retrained one even lost, as in the paper"),
        ([gone, gone], "a loss there, as in the paper, is not shown"),
        (
            [case(0, 0), one],
            "in 1 of our 2 sets of scenes the retrained one even lost, as in the paper",
        ),
    ):
        answer = central.answer(cases)
        assert answer.startswith("The gain does not carry over to the shared error")
        assert answer.endswith(f"; {shown}")
    assert "the loss was significant" in central.detail([one, gone])
    assert "No run" in central.answer([])
    assert central.detail([]) == central.by_training(one) == ""
    for count, verb in ((0, "show"), (1, "shows"), (3, "show")):
        several = one.model_copy(update={"reversing": count, "trainings": 3})
        sentence = central.detail([case(0, 0), several])
        assert f"{count} of 3 trained models {verb} the reversal" in sentence
        assert f"more often ({SIGNS[1]}" in sentence
        assert f"less often ({SIGNS[-1]}" in sentence


def test_the_table_explains_what_a_first_reader_does_not_know() -> None:
    level = case(1, 0).model_copy(update={"ahead": ""})
    (note,) = central.table_of([level]).notes
    assert note.startswith("Neither ahead at any frequency: ")
    (note,) = central.table_of([case(1, 0), case(1, -1)]).notes
    assert note.startswith("Each of our rows is a set of scenes")
    (note,) = central.table_of([case(1, 0)]).notes
    assert note.startswith("Rows are")


def test_an_effect_takes_its_side_from_its_text_only_where_it_is_detected() -> None:
    for sign, text in SIGNS.items():
        assert central.PrintedEffect.of(text, detected=True).sign == (sign or 1)
        unseen = central.PrintedEffect.of(text, detected=False)
        assert unseen.sign == 0
        assert "not significant" in central.clause("There", unseen)


def test_a_run_answers_by_the_papers_rules(found: Reproduction) -> None:
    own = central.case_of(found)
    assert own is not None
    for effect in (own.isolated, own.shared):
        low, high = effect.text.replace("−", "-").split("[")[1].rstrip("]").split(", ")
        assert bool(effect.sign) == (float(low) > 0 or float(high) < 0)
    claim = next(claim for claim in found.ledger.claims if claim.id == central.CLAIM)
    assert own.reversal == (claim.parts[0].answer == "confirmed")
    assert "of 3 trained models" in central.by_training(own)


def test_a_page_answers_with_its_own_run_and_those_of_its_platform(found: Reproduction) -> None:
    here, others = {central.WEIGHTS: central.elsewhere()[0].weights}, len(central.elsewhere())
    own, page = central.case_of(found), central.of_page(found, here)
    quick = central.of_page(found.model_copy(update={"profile": "quick"}), here)
    alone = central.of_page(found, {central.WEIGHTS: "other"})
    assert own
    assert page
    assert quick
    assert alone
    assert len(page[2].lines) == others + 2
    assert "too small" in quick[1]
    assert len(quick[2].lines) == others + 1
    assert alone[:2] == (central.answer([own]), central.detail([own]))
    assert len(alone[2].lines) == 2
    none = found.ledger.model_copy(update={"claims": found.ledger.claims[:3]})
    assert central.of_page(found.model_copy(update={"ledger": none}), here) is None


def test_the_main_job_shows_what_more_scenes_found() -> None:
    assert central.answer(central.elsewhere()) in central.shipped()
    assert central.detail(central.elsewhere()) in central.shipped()


def test_findings_and_matched_properties_are_counted_apart(ledger: Ledger) -> None:
    findings = [claim for claim in ledger.claims if claim.kind == "finding"]
    confirmed = sum(claim.verdict == "confirmed" for claim in findings)
    text = headline(ledger, "paper")
    assert f"{len(findings)} findings, {confirmed} were reproduced" in text
    assert f"of {len(ledger.claims) - len(findings)} properties" in text
    some = ledger.model_copy(update={"claims": tuple(findings[:2]), "left_out": 43})
    assert "2 findings that this run is about" in headline(some, "paper")
    assert "properties" not in headline(some, "paper")
    assert headline(ledger.model_copy(update={"claims": ()}), "paper")
    properties = [c for c in ledger.claims if (c.kind, c.verdict) == ("platform", "confirmed")]
    for count, said in ((1, "Of 1 property that"), (2, "Of 2 properties that")):
        own = headline(ledger.model_copy(update={"claims": tuple(properties[:count])}), "paper")
        hold = "1 holds" if count == 1 else "2 hold"
        assert own == f"{said} the simulator was matched to, {hold} on these scenes"


@pytest.fixture(scope="module")
def ledger() -> Ledger:
    return shipped_ledger()
