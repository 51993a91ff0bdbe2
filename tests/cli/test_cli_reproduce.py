"""The quick profile of the paper's central table, as the command carries it out."""

import shutil
from pathlib import Path

import pytest
from faultpath_paper.cells import QUICK
from faultpath_paper.pages import table_4
from faultpath_paper.reproduction import ReproductionRun, carry_out
from faultpath_paper.run import Plan
from faultpath_paper.verb import show

import faultpath
from faultpath.api.display import Display
from faultpath.api.job import Job
from faultpath.cli.audits import report
from faultpath.core.errors import UserError
from faultpath.decisions.tables import MISSING
from faultpath.trials.work.executor import Here

TOLD = Display(command=("faultpath", "reproduce"))
ASKED = Plan((table_4.PAGE,), QUICK)


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory, selection_held_out: None) -> ReproductionRun:
    return carry_out(ASKED, Job(tmp_path_factory.mktemp("quick"), Here(), TOLD))


def test_every_file_is_there(done: ReproductionRun) -> None:
    assert done.folder.name == "table-4"
    assert {path.name for path in done.folder.iterdir()} == {
        "deliveries.json",
        "evidence.parquet",
        "ledger.md",
        "outcomes.parquet",
        "provenance.json",
        "reproduction.html",
        "reproduction.json",
        "tables.md",
        "traces.parquet",
    }


def test_no_figure_of_ours_is_missing(done: ReproductionRun) -> None:
    (table,) = done.record.tables
    assert MISSING not in {entry.text for line in table.lines for entry in line.entries}


def test_the_ledger_holds_the_claims_that_the_table_is_about(done: ReproductionRun) -> None:
    claims = {claim.id for claim in done.record.ledger.claims}
    assert {"C23", "C24", "C26", "C28", "C29"} <= claims
    assert "C05" not in claims


def test_the_same_command_again_flies_nothing(done: ReproductionRun) -> None:
    again = carry_out(ASKED, Job(done.folder.parent, Here(), TOLD))
    provenance = (again.folder / "provenance.json").read_text("utf-8")
    assert '"blocks_computed": 0' in provenance
    assert again.record.tables == done.record.tables


def test_the_folder_opens_as_it_was_left(done: ReproductionRun) -> None:
    again = faultpath.open_run(done.folder)
    assert isinstance(again, ReproductionRun)
    assert again.record == done.record
    assert again.folder == done.folder


@pytest.mark.parametrize("name", ["reproduction.json", "outcomes.parquet", "deliveries.json"])
def test_a_file_that_was_changed_since_is_named(
    done: ReproductionRun, name: str, tmp_path: Path
) -> None:
    copy = shutil.copytree(done.folder, tmp_path / "received")
    (copy / name).write_bytes((copy / name).read_bytes() + b"\n")
    with pytest.raises(UserError, match=rf"{name} changed since the run"):
        faultpath.open_run(copy)


def test_a_reproduction_is_not_reported_as_an_audit(done: ReproductionRun) -> None:
    with pytest.raises(UserError, match="pages of the reproduction"):
        report([done.folder])


def test_the_tables_are_printed(done: ReproductionRun, capsys: pytest.CaptureFixture[str]) -> None:
    show(done, whole=False)
    assert "Wins:losses" in capsys.readouterr().out
