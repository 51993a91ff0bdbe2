"""What is lost when something goes wrong: as little as can be."""

import json
from pathlib import Path

import pytest
from toy_study import SCENES, SYSTEM, UNITS, study, study_of
from toy_system import STEPS

from faultpath.run.execution.runner import run_study


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
