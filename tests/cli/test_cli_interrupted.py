"""Processes that are stopped, killed, or not alone: nothing finished is lost."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from cli_runs import audit, audit_line, faultpath, shards, start, until
from written import written

from faultpath.cli.main import INTERRUPTED

pytestmark = [pytest.mark.usefixtures("without_pages"), pytest.mark.slow]
SCENES, BLOCKS = 8, 24
SLOW = """block_size = 2
def __init__(self, gate):
    self.gate = Path(gate)
def run(self, *asked):
    import time
    if self.gate.exists():
        time.sleep(0.3)
    return super().run(*asked)"""


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    place = tmp_path_factory.mktemp("undisturbed")
    written(place, SLOW)
    options = _options(place / "no gate", place / "run") | {"workers": 0}
    assert audit(**options).status == 0
    return (place / "run" / "outcomes.parquet").read_bytes()


@pytest.fixture
def gate(tmp_path: Path) -> Path:
    """A file that slows the toy down while it exists."""
    written(tmp_path, SLOW)
    place = tmp_path / "gate"
    place.touch()
    return place


def _options(gate: Path, out: Path) -> dict[str, object]:
    system = f"{gate.parent / 'mine.py'}:create"
    return {"system": system, "set": f"gate={gate}", "out": out, "scenes": SCENES}


def _resumed(run: Path, gate: Path) -> bytes:
    """Finish a run with the gate open and return its table."""
    kept = len(shards(run))
    gate.unlink(missing_ok=True)
    ended = audit(**_options(gate, run))
    assert ended.status == 0, ended.err
    provenance = json.loads((run / "provenance.json").read_text())
    assert provenance["blocks_kept"] == kept
    assert provenance["blocks_computed"] == len(shards(run)) - kept > 0
    assert not list(run.rglob(".partial-*"))
    return (run / "outcomes.parquet").read_bytes()


@pytest.mark.parametrize(
    ("workers", "sent", "status"),
    [
        (0, signal.SIGINT, INTERRUPTED),
        (1, signal.SIGTERM, 143),
        (1, signal.SIGKILL, -signal.SIGKILL),
    ],
)
def test_a_stop_says_what_is_kept_and_goes_on_to_the_same_bytes(
    workers, sent, status, gate, tmp_path, undisturbed
):
    run, words = tmp_path / "run", tmp_path / "words"
    process = start(words, *audit_line(**_options(gate, run), workers=workers))
    until(lambda: len(shards(run)) >= 2, "two blocks")
    process.send_signal(sent)
    assert process.wait(timeout=60) == status
    kept = len(shards(run))
    assert kept < BLOCKS
    assert not (run / "outcomes.parquet").exists()
    if sent != signal.SIGKILL:
        assert "Traceback" not in words.read_text()
        last = words.read_text().splitlines()[-1]
        count = re.match(rf"faultpath: interrupted with (\d+) of {BLOCKS} blocks done", last)
        assert count is not None, last
        # A block whose file was just written may not be counted yet.
        assert kept - 1 <= int(count[1]) <= kept
        assert str(run) in last
        assert "again to resume" in last
    assert _resumed(run, gate) == undisturbed


def test_two_processes_on_one_folder_take_turns(gate, tmp_path, undisturbed):
    run = tmp_path / "run"
    line = audit_line(**_options(gate, run))
    first = start(tmp_path / "first", *line)
    until(lambda: shards(run), "a block of the first")
    second = start(tmp_path / "second", *line)
    until(lambda: "waiting for it" in (tmp_path / "second").read_text(), "the second to wait")
    assert f"another faultpath process (id {first.pid})" in (tmp_path / "second").read_text()
    gate.unlink()
    assert (first.wait(timeout=60), second.wait(timeout=60)) == (0, 0)
    assert (run / "outcomes.parquet").read_bytes() == undisturbed
    assert json.loads((run / "provenance.json").read_text())["blocks_computed"] == 0


def test_ctrl_c_outside_the_run_is_a_sentence_too(monkeypatch, tmp_path):
    def stopped(*_: object) -> None:
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr("faultpath.api.runs.write_report", stopped)
    ended = audit(out=tmp_path / "run")
    assert ended.status == INTERRUPTED
    line = ended.err.splitlines()[-1]
    assert line.startswith("faultpath: interrupted")
    assert "same command" in line
    monkeypatch.undo()
    assert audit(out=tmp_path / "run").status == 0
    assert faultpath("report", tmp_path / "run").status == 0


def test_ctrl_c_pressed_once_more_is_one_sentence_too(monkeypatch):
    def press(*_: object) -> str:
        os.kill(os.getpid(), signal.SIGINT)
        return ""

    monkeypatch.setattr("faultpath.api.runs.write_report", press)
    monkeypatch.setattr("faultpath.core.error_source.location", press)
    ended = audit(out="run", scenes=1)
    assert ended.status == INTERRUPTED
    assert ended.err.splitlines()[-1].startswith("faultpath: interrupted")


STOPPED_WHILE_LOADING = """
import os, signal, sys
class Stop:
    def find_spec(self, name, *_):
        if name == "faultpath.cli.runs":
            try:
                os.kill(os.getpid(), signal.SIGINT)
                signal.sigtimedwait([], 1)
            except KeyboardInterrupt:
                if sys.argv.pop() == "hidden":
                    raise ImportError("a compiled module failed to load") from None
                raise
sys.meta_path.insert(0, Stop())
from faultpath.cli.main import main
main()
"""


@pytest.mark.parametrize("how", ["plain", "hidden"])
def test_ctrl_c_while_the_command_loads_is_a_sentence(how: str) -> None:
    line = [sys.executable, "-c", STOPPED_WHILE_LOADING, "report", "nowhere", how]
    done = subprocess.run(line, capture_output=True, text=True, timeout=60)
    assert done.returncode == INTERRUPTED
    (said,) = done.stderr.splitlines()
    assert said.startswith("faultpath: interrupted")
