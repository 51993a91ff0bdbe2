"""A fault of several sizes: an audit each."""

import pytest
from toy_audits import TOY, VERSIONS

import faultpath
from faultpath.core.errors import UserError
from faultpath.faults import FaultText

ASKED = {**VERSIONS, "scenes": 4, "workers": 0, "progress": False, "signals": False}


@pytest.mark.parametrize(
    ("text", "each"),
    [
        ("gain:scale=0.8,0.9", ("gain:scale=0.8", "gain:scale=0.9")),
        ("c=+0.1,-0.1", ("c=+0.1", "c=-0.1")),
        (
            "v:noise=0.1,0.2,relative,onset=3@p+q",
            ("v:noise=0.1,relative,onset=3@p+q", "v:noise=0.2,relative,onset=3@p+q"),
        ),
        ("v:noise=0.1@p,0.2", ("v:noise=0.1@p", "v:noise=0.2@p")),
        ("w:offset=1/0/0,0/1/0", ("w:offset=1/0/0", "w:offset=0/1/0")),
        ("w:freeze,onset=3", ("w:freeze,onset=3",)),
        ("c=-0.2..0.2/5", ("c=-0.2", "c=-0.1", "c=0", "c=0.1", "c=0.2")),
        ("c=+1..-1/2", ("c=1", "c=-1")),
        ("g:scale=.8..1/2@p,onset=3", ("g:scale=0.8,onset=3@p", "g:scale=1,onset=3@p")),
        ("g:scale=0.8..0.9/2,1.5", ("g:scale=0.8", "g:scale=0.9", "g:scale=1.5")),
    ],
)
def test_a_text_for_each_size(text, each):
    assert tuple(map(str, FaultText.read(text).each())) == each


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("gain:scale=0.8,0.80", "names a size twice"),
        ("gain:freeze,0.8", "0.8 is a further size, and there is no first"),
        ("gain:scale=0.8..0.9", "write FROM..TO/COUNT"),
        ("gain:offset=1/0/0..2/0/0/3", "write FROM..TO/COUNT"),
        ("gain:scale=0.8..0.9/1000000000", "a range takes 2 to 99"),
        ("gain:scale=0.8..0.8/3", "names a size twice"),
    ],
)
def test_lists_that_are_none(text, said):
    with pytest.raises(UserError, match=said):
        FaultText.read(text)


@pytest.mark.usefixtures("without_pages")
def test_each_size_is_an_audit_as_if_alone(tmp_path):
    _, strong = faultpath.api.audits(TOY, fault="gain:scale=0.6,0.8", folder=tmp_path, **ASKED)
    alone = faultpath.audit(TOY, fault="gain:scale=0.8", folder=tmp_path / "alone", **ASKED)
    assert strong.record == alone.record
    assert strong.table() == alone.table()
    with pytest.raises(UserError, match="alone holds a run: give another folder"):
        faultpath.api.audits(TOY, fault="gain:scale=0.6,0.8", folder=alone.folder, **ASKED)


def test_one_audit_takes_one_size():
    with pytest.raises(UserError, match=r"takes one; from Python, faultpath\.api\.audits"):
        faultpath.audit(TOY, fault="gain:scale=0.6..0.8/3", **ASKED)
