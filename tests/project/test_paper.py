"""The shipped reproduction of the paper: its conclusions follow from its tables, file by file."""

import hashlib
from pathlib import Path

import pytest
from faultpath_paper.answers import RUN, Reproduction
from faultpath_paper.cells import PAPER, published_claims
from faultpath_paper.claims import again
from faultpath_paper.pages import PAGES
from faultpath_paper.results import Results
from faultpath_paper.run import read_results

from faultpath.run.provenance import RunProvenance

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "docs" / "reference" / "paper"


Run = tuple[Results, Reproduction]


@pytest.fixture(scope="module")
def run() -> Run:
    return read_results(RUN)


def test_the_claims_follow_from_the_tables(run: Run) -> None:
    results, found = run
    answered = again(results, found.ledger)
    assert rounded(answered.model_dump()) == rounded(found.ledger.model_dump())


def test_tables_and_figures_follow_from_the_outcomes(run: Run) -> None:
    results, found = run
    built = [part for page in PAGES for part in page.build(results)]
    assert {part.name: part for part in built} == {
        part.name: part for part in (*found.tables, *found.figures)
    }


def test_every_variant_of_the_paper_was_flown(run: Run) -> None:
    results, found = run
    wanted = PAPER.cells(cell for page in PAGES for cell in page.cells)
    assert all(results.seeds(cell) == cell.seeds for cell in wanted)
    assert found.trials >= sum(len(cell.seeds) for cell in wanted) * found.ledger.scenes
    assert found.failed_trials == 0
    assert [claim.id for claim in found.ledger.claims] == [c.id for c in published_claims()]


def test_the_outcomes_are_those_that_the_provenance_names() -> None:
    named = RunProvenance.model_validate_json((RUN / "provenance.json").read_bytes())
    digest = hashlib.sha256((RUN / "outcomes.parquet").read_bytes()).hexdigest()
    assert named.files["outcomes.parquet"] == digest


def test_the_report_shows_every_claim_of_the_ledger(run: Run) -> None:
    page = (REFERENCE / "reproduction.html").read_text("utf-8")
    text = (REFERENCE / "ledger.md").read_text("utf-8")
    for claim in run[1].ledger.claims:
        assert claim.id in page
        assert f"| {claim.id} |" in text


def rounded(value: object) -> object:
    """Leave the last digits of one processor out."""
    if isinstance(value, dict):
        return {key: rounded(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(part) for part in value]
    return float(f"{value:.6g}") + 0.0 if isinstance(value, float) else value
