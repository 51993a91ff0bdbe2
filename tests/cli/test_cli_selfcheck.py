"""`faultpath selfcheck statistics`: numbers to a file, tables to the terminal, 1 for a failure."""

import re

import pytest

from faultpath.cli.main import main
from faultpath.selfcheck import PROFILES, Report
from faultpath.selfcheck.detection import detection_grid
from faultpath.selfcheck.run import Profile
from faultpath.statistics import score
from faultpath.work import local

SMALL = Profile((10,), 20, 10, 1, 1, 1, 1, 1, 1, 1)


@pytest.fixture
def check(monkeypatch, capsys):
    """Run the command with next to no samples; return exit status and output."""
    monkeypatch.setitem(PROFILES, "quick", SMALL)
    few = [cell for cell in detection_grid(SMALL.reports) if cell.scenes == 25]
    monkeypatch.setattr("faultpath.selfcheck.run.detection_grid", lambda runs: few)

    def run(*options):
        alone = () if "--processes" in options else ("--processes", "1")
        command = ["faultpath", "selfcheck", "statistics", "--profile", "quick", *alone, *options]
        monkeypatch.setattr("sys.argv", command)
        with pytest.raises(SystemExit) as ended:
            main()
        return ended.value.code, re.sub(r"\s+", " ", capsys.readouterr().out)

    return run


def test_numbers_are_written_and_tables_printed(check, tmp_path):
    out = tmp_path / "found.json"
    status, said = check("--out", str(out))
    assert status == 0, said
    report = Report.model_validate_json(out.read_text())
    assert report.profile == "quick"
    assert len(report.sections) == 15
    for title in ("Interval of an effect, one seed", "Break-even frequency", "Reversals"):
        assert title in said
    assert "No promise is broken by more than three standard errors." in said


@pytest.mark.parametrize("out", ["", "nowhere/found.json", "."])
def test_a_place_that_cannot_be_written_is_refused_before_the_work(out, monkeypatch, capsys):
    monkeypatch.setattr("faultpath.selfcheck.check_statistics", lambda *_: pytest.fail("worked"))
    monkeypatch.setattr("sys.argv", ["faultpath", "selfcheck", "statistics", "--out", out])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_no_more_processes_are_started_than_there_is_work_for(check, monkeypatch):
    """As many as asked ended in an error of the operating system's, with its traceback."""
    started = []

    def few(count):
        started.append(count)
        return local(0)

    monkeypatch.setattr("faultpath.selfcheck.run.local", few)
    status, said = check("--processes", "9" * 30)
    assert status == 0, said
    (count,) = started
    assert 1 < count <= len(SMALL.tasks())


def test_a_wrong_interval_is_found(check, monkeypatch):
    """Half the quantile: 67 % intervals under the name of 95 %."""
    honest = score.rejects

    def hasty(values, counts, null, far, z):
        return honest(values, counts, null, far, z / 2)

    monkeypatch.setattr("faultpath.selfcheck.coverage.rejects", hasty)
    status, said = check()
    assert status == 1
    assert "Not kept: the 95 % interval of an effect covers the truth in 0." in said
