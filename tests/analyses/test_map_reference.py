"""The reference map of the documents is what its trials give."""

from dataclasses import replace
from pathlib import Path

import pytest

from faultpath.analyses.map.lattice import UNITS
from faultpath.analyses.map.record import MapRecord
from faultpath.analyses.map.study import plan_map
from faultpath.run import Deliveries, SystemSpec, load_system
from faultpath.run.store.folder import read_outcomes
from faultpath.system import library_of

ROOT = Path(__file__).resolve().parents[2]
MAPS = sorted(path.parent for path in (ROOT / "docs" / "reference").glob("*/map.json"))


@pytest.mark.parametrize("folder", MAPS, ids=lambda condition: condition.name)
def test_a_reference_map_follows_from_its_outcomes(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    record = MapRecord.model_validate_json((folder / "map.json").read_bytes())
    question, facts = record.question, record.facts
    spec = SystemSpec(name=facts.system, options=question.options)
    system = load_system(spec)
    plan = plan_map(system, spec, question, library_of(system, facts.library))
    # Under other versions of packages an environment has other scenes; the trials are of these.
    assert plan.question == question
    assert plan.facts.model_copy(update={"library_hash": facts.library_hash}) == facts
    plan = replace(plan, facts=facts)
    points = [
        (round(x / facts.up_to * UNITS), round(y / facts.up_to * UNITS))
        for x, y in (point.errors for point in record.points)
    ]
    table = read_outcomes(folder / "outcomes.parquet")
    noted = Deliveries(rows=(), findings=record.findings)
    again = plan.conclude(table, noted, points)
    if folder.name == "map-toy":
        turned = plan.conclude(table, noted, points[::-1])
        assert turned == again, "the order in which points were flown is in the record"
    assert again.sentences == record.sentences
    assert again.headline == record.headline
    for one, two in zip(again.points, record.points, strict=True):
        assert (one.errors, one.sign, one.won, one.lost) == (
            two.errors,
            two.sign,
            two.won,
            two.lost,
        )
        assert (one.low, one.high) == pytest.approx((two.low, two.high), abs=1e-6)
