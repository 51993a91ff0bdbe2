"""The quick profile of the paper's central table, as the command carries it out."""

import json
import shutil
from pathlib import Path

import pytest
from cli_runs import faultpath as command
from faultpath_paper.cells import QUICK, published_claims
from faultpath_paper.pages import table_4
from faultpath_paper.reproduction import ReproductionRun, carry_out
from faultpath_paper.run import ReproductionPlan
from faultpath_paper.verb import show

import faultpath
from faultpath.api.display import Display
from faultpath.api.job import Job
from faultpath.core.errors import UserError
from faultpath.decisions.tables import MISSING
from faultpath.trials.work.executor import Here

PLAN = ReproductionPlan((table_4.PAGE,), QUICK)
DISPLAY = Display(command=("faultpath", "reproduce"))


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory, selection_held_out: None) -> ReproductionRun:
    return carry_out(PLAN, Job(tmp_path_factory.mktemp("quick"), Here(), DISPLAY))


def test_every_file_is_there_and_no_figure_of_ours_is_missing(done: ReproductionRun) -> None:
    assert done.folder.name == "table-4"
    assert {path.name for path in done.folder.iterdir()} == {
        *("deliveries.json", "provenance.json", "reproduction.json"),
        *("evidence.parquet", "outcomes.parquet", "traces.parquet"),
        *("ledger.md", "tables.md", "reproduction.html"),
    }
    (table,) = done.record.tables
    assert MISSING not in {entry.text for line in table.lines for entry in line.entries}


def test_the_ledger_holds_the_claims_that_the_table_is_about(done: ReproductionRun) -> None:
    claims = {claim.id for claim in done.record.ledger.claims}
    assert {"C23", "C24", "C26", "C28", "C29"} <= claims
    assert "C05" not in claims


def test_the_same_command_again_flies_nothing(done: ReproductionRun) -> None:
    again = carry_out(PLAN, Job(done.folder.parent, Here(), DISPLAY))
    assert '"blocks_computed": 0' in (again.folder / "provenance.json").read_text("utf-8")
    assert again.record.tables == done.record.tables


def test_the_folder_opens_as_it_was_left(done: ReproductionRun) -> None:
    again = faultpath.open_run(done.folder)
    assert isinstance(again, ReproductionRun)
    assert (again.record, again.folder) == (done.record, done.folder)


@pytest.mark.parametrize("name", ["reproduction.json", "outcomes.parquet", "deliveries.json"])
def test_a_file_that_was_changed_since_is_named(
    done: ReproductionRun, name: str, tmp_path: Path
) -> None:
    copy = shutil.copytree(done.folder, tmp_path / "received")
    (copy / name).write_bytes((copy / name).read_bytes() + b"\n")
    with pytest.raises(UserError, match=rf"{name} changed since the run"):
        faultpath.open_run(copy)


def test_a_reproduction_is_not_reported_as_an_audit(done: ReproductionRun) -> None:
    command("report", done.folder).refused("pages of the reproduction")


def test_the_tables_are_printed(done: ReproductionRun, capsys: pytest.CaptureFixture[str]) -> None:
    show(done, whole=False)
    assert "Wins:losses" in capsys.readouterr().out


def test_the_shipped_claims_are_json() -> None:
    printed = command("reproduce", "--judge", "--json")
    assert printed.status == 0, printed.err
    claims = json.loads(printed.out)
    assert [claim["id"] for claim in claims] == [claim.id for claim in published_claims()]
    fields = {"id", "kind", "verdict", "estimate", "interval", "mde", "paper"}
    assert all(fields <= set(claim) for claim in claims)
    assert {claim["verdict"] for claim in claims} <= {"confirmed", "refuted", "undecided"}
