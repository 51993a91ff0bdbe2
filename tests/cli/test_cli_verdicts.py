"""What an audit of the toy announces, and what it does not."""

import re
from pathlib import Path

import pytest
from cli_runs import audit

from faultpath.door.run import open_run
from faultpath.record import DecisionRecord, phrases


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def audited(**options: object) -> tuple[DecisionRecord, str]:
    """Return the record of an audit of the toy, and all that was printed."""
    ended = audit(**{"out": "run", "scenes": 20} | options)
    assert (ended.status, ended.err) == (0, "")
    return open_run(Path("run")).record, " ".join(ended.out.split())


def seen() -> str:
    """Return the text of the page without styles, scripts and names of classes."""
    page = Path("run/report.html").read_text()
    page = re.sub(r"<(style|script)\b.*?</\1>", "", page, flags=re.DOTALL)
    return re.sub(r"\b(class|id|href|aria-labelledby)=\"[^\"]*\"", "", page)


def test_three_scenes_are_too_few_to_decide():
    record, printed = audited(scenes=3)
    said = "Too few scenes to decide: 3 compared, and this question needs at least 7."
    assert record.verdict.headline == said
    assert said in printed
    for text in (printed, seen()):
        assert "Do not choose" not in text
        assert not re.search(r"(blind|calibrated) (is ahead|succeeds more often)", text)


@pytest.mark.parametrize("fault", ["gain:scale=0.6,onset=5000", "gain:scale=1"])
def test_a_fault_that_never_acted_is_reported_as_such(fault):
    record, printed = audited(fault=fault)
    assert "The fault never acted: nothing was tested." in printed
    for effect in record.effects[1:]:
        said = phrases.effect(record, effect)
        assert "nothing was tested" in said
        assert "difference" not in said
    assert "fault never acted" in seen()
    assert "not tested" in Path("run/table.md").read_text()


def test_the_primary_contrast_may_be_named():
    record, printed = audited(primary="controller")
    assert record.question.primary == "controller"
    assert "(primary" in printed
    assert record.verdict.headline.startswith(("With only the controller", "No difference"))
    refused = audit(primary="pilot").refused()
    assert "no path 'pilot'" in refused
    assert "correct, controller, observer, shared" in refused


def test_a_cart_neither_flies_nor_has_trained_models_nor_times_out():
    _, printed = audited()
    assert "Running" in printed
    for text in (printed, seen()):
        assert not re.search(r"\b(fly|flies|Flying|flights?|flown|trained|timeouts?)\b", text)
    assert "missed" in seen()
    assert "--generalise models" in audit(generalise="models").refused()


def test_what_is_secondary_is_called_so_and_marked_nowhere():
    audited()
    assert "secondary; less is better" in seen()
    assert "nothing is decided from them" in seen()
    assert "Secondary, nothing is decided" in Path("run/table.md").read_text()
