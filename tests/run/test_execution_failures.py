"""What is lost when something goes wrong: as little as can be."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from calls import alive, until
from toy_study import SCENES, SYSTEM, UNITS, study, study_of
from toy_system import STEPS

from faultpath.run.execution.runner import run_study
from faultpath.run.plan import Study

_RUN = """
import sys
from pathlib import Path
from faultpath.core.errors import Stopped
from faultpath.run.execution.runner import run_study
from faultpath.run.plan import Study

study = Study.model_validate_json(Path(sys.argv[1]).read_text())
try:
    result = run_study(study, sys.argv[2], workers=2, notice=print, recheck=False)
except Stopped as error:
    print(error)
    sys.exit(130)
print(f"computed {result.blocks_computed} kept {result.blocks_kept}")
"""


def _slow(tmp_path: Path) -> tuple[Study, Path, Path]:
    """Return a study that is slow while a file exists, that file, and the log of its calls.

    It hangs while the file `hang` exists.
    """
    log, gate = tmp_path / "log", tmp_path / "slow"
    gate.touch()
    options = {"log": log, "slow_while": gate, "hang_while": tmp_path / "hang"}
    return study(**{name: str(path) for name, path in options.items()}), gate, log


def _start(study: Study, folder: Path, out: Path) -> subprocess.Popen[str]:
    """Run a study in a process of its own, in a session of its own, printing into a file."""
    definition = out.with_suffix(".json")
    definition.write_text(study.model_dump_json())
    with out.open("w") as stdout:
        return subprocess.Popen(
            [sys.executable, "-u", "-c", _RUN, str(definition), str(folder)],
            stdout=stdout,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
        )


def _shards(folder: Path) -> int:
    return len(list(folder.glob("shards/*.parquet")))


def _calls(log: Path) -> list[list[str]]:
    return [line.split() for line in log.read_text().splitlines()]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("undisturbed")
    run_study(study(), folder, workers=0)
    return folder


def _same_tables(one: Path, two: Path) -> bool:
    names = ("outcomes.parquet", "traces.parquet")
    return all((one / name).read_bytes() == (two / name).read_bytes() for name in names)


def test_a_run_killed_at_any_moment_resumes_to_the_same_bytes(undisturbed, tmp_path):
    folder = tmp_path / "run"
    slow, gate, log = _slow(tmp_path)
    process = _start(slow, folder, tmp_path / "out")
    until(lambda: _shards(folder) >= 3, "three shards")
    hang = tmp_path / "hang"
    hang.touch()
    until(lambda: len(_calls(log)) >= _shards(folder) + 2, "workers in the middle of a block")
    process.kill()
    process.wait()
    workers = {int(call[-1]) for call in _calls(log)}
    assert process.pid not in workers
    until(lambda: not any(map(alive, workers)), "the workers' end")
    hang.unlink()
    gate.unlink()
    kept = _shards(folder)
    assert kept < UNITS
    (folder / "shards" / ".partial-left").write_bytes(b"half a shard")
    result = run_study(slow, folder, workers=2)
    assert result.blocks_kept == kept
    assert result.blocks_computed == UNITS - kept
    assert _same_tables(undisturbed, folder)
    assert not list(folder.rglob(".partial-*"))


def test_ctrl_c_stops_the_workers_and_keeps_what_is_done(undisturbed, tmp_path):
    folder = tmp_path / "run"
    slow, gate, log = _slow(tmp_path)
    process = _start(slow, folder, tmp_path / "out")
    until(lambda: _shards(folder) >= 2, "two shards")
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: parent and workers alike
    assert process.wait(timeout=60) == 130
    gate.unlink()
    kept = _shards(folder)
    assert f"interrupted with {kept} of {UNITS} blocks done" in (tmp_path / "out").read_text()
    assert not any(alive(int(call[-1])) for call in _calls(log))
    assert run_study(slow, folder, workers=2).blocks_kept == kept
    assert _same_tables(undisturbed, folder)


def test_two_processes_in_one_folder_do_each_block_once(undisturbed, tmp_path):
    folder = tmp_path / "run"
    slow, gate, log = _slow(tmp_path)
    told = [tmp_path / "one", tmp_path / "two"]
    processes = [_start(slow, folder, out) for out in told]
    waiting = f"works in {folder}; waiting for it"
    until(lambda: any(waiting in out.read_text() for out in told), "one to wait for the other")
    gate.unlink()
    assert [process.wait(timeout=60) for process in processes] == [0, 0]
    outputs = [out.read_text() for out in told]
    calls = [tuple(call[:-1]) for call in _calls(log)]
    assert sum(f"computed {UNITS} kept 0" in out for out in outputs) == 1
    assert waiting in next(out for out in outputs if f"computed 0 kept {UNITS}" in out)
    assert len(calls) == UNITS
    assert _same_tables(undisturbed, folder)


def test_a_scene_that_fails_loses_itself_alone(undisturbed, tmp_path):
    result = run_study(study(raises="s05"), tmp_path, workers=2)
    sound = run_study(study(), undisturbed, workers=0)
    for row, expected in zip(result.trials, sound.trials, strict=True):
        if row.outcome.scene == "s05":
            assert row.outcome.failed
            assert row.outcome.error == "ValueError: no air in s05"
        else:
            assert row.outcome.metrics == expected.outcome.metrics
    (planner,) = result.deliveries.at("plain", "correct")
    assert planner.deliveries == 2 * STEPS * (len(SCENES) - 1)
    assert len(result.failures) == len(study().treatments())
    for failure in result.failures:
        assert failure.scene == "s05"
        text = failure.details.read_text()
        assert 'raise ValueError(f"no air in' in text
        assert json.dumps(failure.treatment.variant) in text


def test_what_failed_is_tried_again_and_nothing_else(undisturbed, tmp_path):
    log, gate = tmp_path / "log", tmp_path / "no-air"
    gate.touch()
    options = {"raises": "s05", "while": str(gate), "log": str(log)}
    first = run_study(study(**options), tmp_path / "run", workers=0)
    assert first.failures
    before = len(_calls(log))
    again = run_study(study(**options), tmp_path / "run", workers=0)
    assert again.failures == first.failures
    assert {call[2][:3] for call in _calls(log)[before:]} <= {"s04", "s05", "s06", "s07"}

    gate.unlink()
    notices: list[str] = []
    healed = run_study(study(**options), tmp_path / "run", workers=2, notice=notices.append)
    assert not healed.failures
    assert _same_tables(undisturbed, tmp_path / "run")
    assert not list((tmp_path / "run" / "failures").iterdir())
    assert _shards(tmp_path / "run") == UNITS
    (notice,) = notices
    assert notice.startswith(
        "Kept 72 of 120 trials, from 20"
    )  # a treatment stands twice in the table
    assert "10 that failed are tried again" in notice


def test_a_worker_that_dies_once_costs_nothing(undisturbed, tmp_path):
    once, log = tmp_path / "died", tmp_path / "log"
    mortal = study(dies="s05", once=str(once), log=str(log))
    result = run_study(mortal, tmp_path / "run", workers=2, recheck=False)
    assert len(_calls(log)) == UNITS + 1  # its block ran again, as a whole
    assert not result.failures
    assert _same_tables(undisturbed, tmp_path / "run")


def test_a_scene_that_kills_its_worker_loses_itself_alone(tmp_path):
    result = run_study(study_of(SYSTEM, dies="s05"), tmp_path, workers=2)
    assert [trial.outcome.scene for trial in result.trials if trial.outcome.failed] == ["s05"]
    (failure,) = result.failures
    assert "SIGKILL" in failure.error
    assert "SIGKILL" in failure.details.read_text()


def test_a_system_that_takes_one_scene_at_a_time_is_found_again_by_the_second_call(tmp_path):
    for computed in (UNITS, 0):
        result = run_study(study(alone="plain"), tmp_path / "run", workers=0, recheck=False)
        assert result.blocks_computed == computed
        assert not result.failures
        (finding,) = (text for text in result.findings if "when each ran alone" in text)
        assert "the truth value of an array is ambiguous" in finding
        assert f" of {UNITS} blocks" in finding
