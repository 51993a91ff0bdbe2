"""The quick profile of the paper's central table, as the command carries it out."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from cli_runs import faultpath as command
from faultpath_paper.cells import QUICK, published_claims
from faultpath_paper.pages import table_4
from faultpath_paper.reproduction import ReproductionRun, carry_out
from faultpath_paper.run import ChosenPages
from faultpath_paper.verb import show
from faultpath_quadrotor.plant import module

import faultpath
from faultpath.api.display import Display
from faultpath.api.job import Job
from faultpath.core.errors import UserError
from faultpath.report.tables import MISSING
from faultpath.run.work.executor import Here

CHOSEN = ChosenPages((table_4.PAGE,), QUICK)
DISPLAY = Display(command=("faultpath", "reproduce"))


@pytest.fixture(scope="module")
def done(
    tmp_path_factory: pytest.TempPathFactory, selection_held_out: None
) -> Iterator[ReproductionRun]:
    """A reproduction whose flights are short."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "CONTROL_STEPS", 8)
        yield carry_out(CHOSEN, Job(tmp_path_factory.mktemp("quick"), Here(), DISPLAY))


def test_a_reproduction_leaves_its_files_claims_and_table(
    done: ReproductionRun, capsys: pytest.CaptureFixture[str]
) -> None:
    assert {path.name for path in done.folder.iterdir()} == {
        *("deliveries.json", "provenance.json", "reproduction.json"),
        *("evidence.parquet", "outcomes.parquet", "traces.parquet"),
        *("ledger.md", "tables.md", "reproduction.html"),
    }
    (table,) = done.record.tables
    assert MISSING not in {entry.text for line in table.lines for entry in line.entries}
    claims = {claim.id for claim in done.record.ledger.claims}
    assert {"C23", "C24", "C26", "C28", "C29"} <= claims
    assert "C05" not in claims
    show(done, whole=False)
    assert "Wins:losses" in capsys.readouterr().out


def test_the_same_again_runs_nothing_and_opens_as_it_was_left(done: ReproductionRun) -> None:
    again = carry_out(CHOSEN, Job(done.folder.parent, Here(), DISPLAY))
    assert '"blocks_computed": 0' in (again.folder / "provenance.json").read_text("utf-8")
    assert again.record.tables == done.record.tables
    opened = faultpath.open_run(done.folder)
    assert isinstance(opened, ReproductionRun)
    assert (opened.record, opened.folder) == (done.record, done.folder)
    command("report", done.folder).refused("pages of the reproduction")


@pytest.mark.parametrize(
    "name", ["reproduction.json", "outcomes.parquet", "evidence.parquet", "deliveries.json"]
)
def test_a_file_that_was_changed_since_is_named(
    done: ReproductionRun, name: str, tmp_path: Path
) -> None:
    copy = shutil.copytree(done.folder, tmp_path / "received")
    (copy / name).write_bytes((copy / name).read_bytes() + b"\n")
    with pytest.raises(UserError, match=rf"{name} changed since the run"):
        faultpath.open_run(copy)


def test_the_shipped_claims_are_json() -> None:
    printed = command("reproduce", "--judge", "--json")
    assert printed.status == 0, printed.err
    claims = json.loads(printed.out)
    assert [claim["id"] for claim in claims] == [claim.id for claim in published_claims()]
    fields = {"id", "kind", "verdict", "estimate", "interval", "mde", "paper"}
    assert all(fields <= set(claim) for claim in claims)
    assert {claim["verdict"] for claim in claims} <= {"confirmed", "refuted", "undecided"}
