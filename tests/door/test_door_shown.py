"""Results in a console are a line, and in a notebook tables."""

from pathlib import Path

import pytest

import faultpath
from faultpath.door import check, trace
from faultpath.record import RunProvenance

ROOT = Path(__file__).resolve().parents[2]
TOY = f"{ROOT / 'examples' / 'toy.py'}:create"
ASKED = {"baseline": "calibrated", "repair": "blind", "library": "carts", "progress": False}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> faultpath.Run:
    folder = tmp_path_factory.mktemp("shown") / "run"
    return faultpath.audit(TOY, fault="gain:scale=0.6", scenes=4, workers=0, folder=folder, **ASKED)


def test_an_audit_and_its_record(run: faultpath.Run) -> None:
    shown(run, run.record, run.provenance, *run.record.effects, *run.record.break_even)
    headline = run.record.verdict.headline
    assert headline[:60] in repr(run.record)
    assert str(run.record) == repr(run.record)
    assert isinstance(run.provenance, RunProvenance)


def test_maps_plans_and_what_a_reviewer_sees(tmp_path: Path) -> None:
    found = faultpath.reversal_map(
        TOY,
        fault="gain:scale",
        against="controller,observer",
        up_to=0.4,
        points=25,
        scenes=3,
        workers=0,
        folder=tmp_path / "map",
        **ASKED,
    )
    assert found.record.question.against == ("controller", "observer")
    planned = faultpath.plan(TOY, fault="gain:scale=0.6", scenes=3, workers=0, **ASKED)
    assert planned.plan.study.audits[0].fault.startswith("gain:scale=0.6")
    seen = trace(TOY, library="carts", steps=2)
    report = check(TOY, library="carts", scenes=2, workers=0, progress=False)
    shown(found, found.record, planned, planned.plan, seen, report, report.checks[0])


def shown(*results: object) -> None:
    for each in results:
        assert len(repr(each)) < 400, type(each)
        assert "\n" not in repr(each)
        html = each._repr_html_()  # type: ignore[attr-defined]
        assert "<table" in html, type(each)
