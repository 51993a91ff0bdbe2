"""Output that nobody reads, that is closed, or that a terminal has no letters or columns for."""

import os
import subprocess
from pathlib import Path

import pytest
from cli_runs import COMMAND, ROOT, TOY

from faultpath.cli.main import EXIT_BROKEN_PIPE

REFERENCE = ROOT / "docs" / "reference"
REPORT = ["report", REFERENCE / "toy", REFERENCE / "dock"]
MISTAKE = ["report", "nowhere"]
VARIANTS = ["--baseline", "calibrated", "--repair", "blind"]
AUDIT = ["audit", TOY, *VARIANTS, "--fault", "gain:scale=0.6", "--library", "carts"]


@pytest.mark.parametrize(("line", "stream"), [(REPORT, "stdout"), (MISTAKE, "stderr")])
def test_what_nobody_reads_ends_the_command(line: list[object], stream: str) -> None:
    reads, writes = os.pipe()
    os.close(reads)
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | {stream: writes}
    done = subprocess.run([*COMMAND, *line], **streams, timeout=60)
    os.close(writes)
    assert (done.returncode, done.stdout or b"", done.stderr or b"") == (EXIT_BROKEN_PIPE, b"", b"")


@pytest.mark.parametrize(("line", "status"), [(REPORT, 0), (MISTAKE, 2)])
@pytest.mark.parametrize("closed", [">&-", "2>&-"])
def test_a_closed_stream_changes_no_status(line: list[object], status: int, closed: str) -> None:
    done = subprocess.run(["sh", "-c", f'"$@" {closed}', "sh", *COMMAND, *line], timeout=60)
    assert done.returncode == status


@pytest.mark.parametrize(("stream", "status"), [("2>&-", 0), ("2>/dev/full", 2)])
def test_an_audit_whose_messages_nothing_takes(stream: str, status: int, tmp_path: Path) -> None:
    """Workers start without standard error, and a full disk does not look like a finding, 1."""
    line = [*COMMAND, *AUDIT, "--scenes", "2", "--workers", "1", "--out", tmp_path / "run"]
    done = subprocess.run(["sh", "-c", f'"$@" {stream}', "sh", *line], timeout=60)
    assert done.returncode == status
    assert (tmp_path / "run" / "record.json").exists() == (status == 0)


@pytest.mark.parametrize(
    ("name", "value", "shown"),
    [("PYTHONIOENCODING", "ascii", "Baseline \\u2192"), ("COLUMNS", "0", "Baseline →")],
)
def test_a_terminal_without_letters_or_columns_gets_all_of_it(
    name: str, value: str, shown: str
) -> None:
    environment = {**os.environ, name: value}
    done = subprocess.run([*COMMAND, *REPORT], capture_output=True, timeout=60, env=environment)
    assert (done.returncode, done.stderr) == (0, b"")
    assert shown in done.stdout.decode()
