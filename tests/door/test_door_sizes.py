"""A fault of several sizes: an audit each, and what they have in common flies once."""

from pathlib import Path

import pytest

import faultpath
from faultpath.errors import UserError
from faultpath.faults.sizes import each_size
from faultpath.report.sizes import by_size

TOY = Path(__file__).resolve().parents[2] / "examples" / "toy.py"
ASKED = {
    "baseline": "calibrated",
    "repair": "blind",
    "library": "carts",
    "scenes": 12,
    "workers": 0,
    "progress": False,
}


@pytest.mark.parametrize(
    ("text", "each"),
    [
        ("gain:scale=0.8", ("gain:scale=0.8",)),
        ("gain:scale=0.8,0.9", ("gain:scale=0.8", "gain:scale=0.9")),
        ("c=+0.1,-0.1", ("c=+0.1", "c=-0.1")),
        (
            "v:noise=0.1,0.2,relative,onset=3@p+q",
            ("v:noise=0.1,relative,onset=3@p+q", "v:noise=0.2,relative,onset=3@p+q"),
        ),
        ("v:noise=0.1@p,0.2", ("v:noise=0.1@p", "v:noise=0.2@p")),
        ("v:noise=0.1,0.2@p", ("v:noise=0.1@p", "v:noise=0.2@p")),
        ("w:offset=1/0/0,0/1/0", ("w:offset=1/0/0", "w:offset=0/1/0")),
        ("w:freeze,onset=3", ("w:freeze,onset=3",)),
    ],
)
def test_a_text_for_each_size(text, each):
    assert each_size(text) == each


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("gain:scale=0.8,0.80", "names a size twice"),
        ("gain:freeze,0.8", "0.8 is a further size, and there is no first"),
    ],
)
def test_lists_that_are_none(text, said):
    with pytest.raises(UserError, match=said):
        each_size(text)


def test_the_arms_that_sizes_share_fly_once_and_the_others_as_if_alone(tmp_path):
    weak, strong = faultpath.audits(TOY, fault="gain:scale=0.6,0.8", folder=tmp_path, **ASKED)
    alone = faultpath.audit(TOY, fault="gain:scale=0.8", folder=tmp_path / "alone", **ASKED)
    assert strong.record == alone.record
    assert strong.table() == alone.table()
    held = {
        run.folder.name: {path.name: path for path in (run.folder / "shards").iterdir()}
        for run in (weak, strong, alone)
    }
    shared = set(held["size-1"]) & set(held["size-2"])
    assert len(shared) == len(set(held["size-1"]) & set(held["alone"]))
    assert shared
    for name in shared:
        first, second = held["size-1"][name].stat(), held["size-2"][name].stat()
        assert first.st_mtime_ns == second.st_mtime_ns, "taken over, not flown"
    table = by_size([weak.record, strong.record])
    assert [line.label for line in table.lines] == ["gain:scale=0.6", "gain:scale=0.8"]
    assert table.columns[0] == "Correct inputs"
    assert table.lines[0].entries[0].text == table.lines[1].entries[0].text


def test_one_audit_takes_one_size():
    with pytest.raises(UserError, match=r"several sizes: audit each with faultpath\.audits"):
        faultpath.audit(TOY, fault="gain:scale=0.6,0.8", **ASKED)
