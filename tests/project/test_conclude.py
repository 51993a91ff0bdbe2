"""Stored results follow from their own trials: those of reference runs, and of the paper."""

import hashlib
import json
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import conclude
import pytest
from faultpath_paper.answers import RUN, Reproduction
from faultpath_paper.cells import PAPER, published_claims
from faultpath_paper.claims import again
from faultpath_paper.pages import PAGES
from faultpath_paper.results import Results
from faultpath_paper.run import read_results

from faultpath.api.folders import MAP, RECORD, SCAN
from faultpath.api.runs import open_run
from faultpath.run.provenance import RunProvenance

REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference"
KINDS = {RECORD: conclude.audit, MAP: conclude.reversal_map, SCAN: conclude.scan}
RESULTS = sorted(path for kind in KINDS for path in REFERENCE.glob(f"*/{kind}"))


def rounded(value: object) -> object:
    """Leave out the last digits of one processor."""
    if isinstance(value, dict):
        return {key: rounded(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(part) for part in value]
    return round(float(f"{value:.6g}"), 6) + 0.0 if isinstance(value, float) else value


@pytest.mark.parametrize("stored", RESULTS, ids=lambda path: path.parent.name)
def test_a_stored_result_follows_from_its_trials(
    stored: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = Path(shutil.copytree(stored.parent, tmp_path / stored.parent.name))
    monkeypatch.setattr(conclude, "open_run", lambda _: SimpleNamespace(report=lambda: None))
    KINDS[stored.name](folder)
    again = json.loads((folder / stored.name).read_bytes())
    assert rounded(again) == rounded(json.loads(stored.read_bytes()))
    if "deliveries.json" in json.loads((folder / "provenance.json").read_bytes()).get("files", {}):
        open_run(folder)


def test_the_order_in_which_points_of_a_map_ran_is_not_in_its_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = Path(shutil.copytree(REFERENCE / "map-toy", tmp_path / "map-toy"))
    run = conclude.load("map-toy")
    turned = run.record.model_copy(update={"points": run.record.points[::-1]})
    again = conclude.reversal_map(folder)
    monkeypatch.setattr(conclude, "load", lambda _: replace(run, record=turned))
    monkeypatch.setattr(conclude.load, "cache_clear", lambda: None, raising=False)
    assert conclude.reversal_map(folder) == again


def test_a_run_decided_anew_is_still_enough_for_report(tmp_path: Path) -> None:
    toy = Path(shutil.copytree(REFERENCE / "toy", tmp_path / "toy"))
    traces = (toy / "traces.parquet").read_bytes()
    record = json.loads((toy / RECORD).read_bytes())
    record["effects"][0]["value"] = 12.345
    (toy / RECORD).write_text(json.dumps(record))
    assert conclude.audit(toy).effects[0].value != 12.345
    before = {path.name: path.read_bytes() for path in toy.iterdir()}
    open_run(toy).report()
    assert {path.name: path.read_bytes() for path in toy.iterdir()} == before
    assert b"12.345" not in b"".join(before.values())
    assert before["traces.parquet"] == traces


Run = tuple[Results, Reproduction]


@pytest.fixture(scope="module")
def run() -> Run:
    return read_results(RUN)


def test_the_claims_follow_from_the_tables(run: Run) -> None:
    results, reproduction = run
    answered = again(results, reproduction.ledger)
    assert rounded(answered.model_dump()) == rounded(reproduction.ledger.model_dump())


def test_tables_and_figures_follow_from_the_outcomes(run: Run) -> None:
    results, reproduction = run
    built = [part for page in PAGES for part in page.build(results)]
    assert {part.name: part for part in built} == {
        part.name: part for part in (*reproduction.tables, *reproduction.figures)
    }


def test_every_variant_of_the_paper_was_flown(run: Run) -> None:
    results, reproduction = run
    cells = PAPER.cells(cell for page in PAGES for cell in page.cells)
    assert all(results.seeds(cell) == cell.seeds for cell in cells)
    assert (
        reproduction.trials >= sum(len(cell.seeds) for cell in cells) * reproduction.ledger.scenes
    )
    assert reproduction.failed_trials == 0
    assert [claim.id for claim in reproduction.ledger.claims] == [c.id for c in published_claims()]


def test_the_outcomes_are_those_that_the_provenance_names() -> None:
    named = RunProvenance.model_validate_json((RUN / "provenance.json").read_bytes())
    digest = hashlib.sha256((RUN / "outcomes.parquet").read_bytes()).hexdigest()
    assert named.files["outcomes.parquet"] == digest


def test_the_report_shows_every_claim_of_the_ledger(run: Run) -> None:
    page = (REFERENCE / "paper" / "reproduction.html").read_text("utf-8")
    text = (REFERENCE / "paper" / "ledger.md").read_text("utf-8")
    for claim in run[1].ledger.claims:
        assert claim.id in page
        assert f"| {claim.id} |" in text
