"""An audit that is extended by hand says what was concluded from its trials before."""

from importlib import import_module

import pytest
from toy_audits import AUDIT, TOY

import faultpath
from faultpath.report.sentences.answers import answers

AUDIT_MODULE = import_module("faultpath.api.audit")
FIVE_PERCENT = "at most 5 % of audits would report any difference"


pytestmark = pytest.mark.usefixtures("elsewhere", "without_pages")


def audited(**asked) -> faultpath.Run:
    return faultpath.audit(TOY, **(AUDIT | {"folder": "run", "signals": False} | asked))


def said(run: faultpath.Run) -> str:
    return " ".join((*run.words.findings, *answers(run.record).values()))


def test_more_scenes_in_the_same_folder_leave_a_trace_that_stays(monkeypatch):
    first = audited(scenes=12)
    assert audited(scenes=12).record == first.record
    assert FIVE_PERCENT in said(first)
    assert not first.record.earlier
    more = audited(scenes=20, signals=True)
    assert [analysis.scenes for analysis in more.record.earlier] == [12]
    assert "concluded before with 12 scenes" in said(more)
    assert FIVE_PERCENT not in said(more)
    with monkeypatch.context() as killed:
        killed.setattr(AUDIT_MODULE, "seal", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            audited(scenes=20, signals=True)
    assert audited(scenes=20).record == more.record
    back = audited(scenes=12)
    assert [analysis.scenes for analysis in back.record.earlier] == [20]


def test_another_primary_contrast_is_a_look():
    audited(scenes=12)
    found = audited(scenes=12, primary="correct").record
    assert [(analysis.scenes, analysis.primary) for analysis in found.earlier] == [(12, "shared")]


def test_what_could_announce_nothing_is_no_look():
    audited(scenes=3)
    assert not audited(scenes=12).record.earlier


def test_sequential_looks_are_allowed_for_as_long_as_they_lead_to_one_contrast():
    audited(scenes=15, stop_when="decided")
    assert not audited(scenes=20, stop_when="all-decided").record.earlier
    other = audited(scenes=20, stop_when="all-decided", primary="correct").record
    assert [(analysis.scenes, analysis.primary) for analysis in other.earlier] == [(None, "shared")]
