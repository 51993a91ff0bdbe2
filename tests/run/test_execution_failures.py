"""What is lost to a system that hangs, exits, fails, dies or returns nonsense: little."""

import math
import os
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from toy_plan import SCENES, SYSTEM, UNITS, plan, plan_of
from weighed import ToySystem

from faultpath.core.errors import SystemMistake, UserError
from faultpath.loop import Reading
from faultpath.report.sentences.findings import describe
from faultpath.run.execution import dispatch
from faultpath.run.execution.runner import run_plan
from faultpath.run.execution.state import FEW
from faultpath.system import Status

pytestmark = pytest.mark.slow  # all together

WRONG = {
    "distance": {"metrics": {"distance": math.nan}},
    "status": {"status": "success"},
    "object": {"trace": lambda: None},  # would not even cross to the parent
    "surrogate": {"initial_hash": "\ud800"},
    "error": {"status": Status.FAILED, "error": "lost \ud800"},
    "nothing": lambda outcomes: None,
    "dict": lambda outcomes: [vars(outcome) for outcome in outcomes],
    "order": lambda outcomes: outcomes[::-1],
}


class Unruly(ToySystem):
    """Does one unruly thing, in the scene `where` or in all."""

    def run(self, variant, scenes, taps, seed):
        does, where = self._options["does"], self._options.get("where")
        mass = np.ones(len(scenes))
        match does if where in (None, *scenes) else "":
            case "hang":
                time.sleep(600)
            case "exit":
                sys.exit(int(self._options["status"]))
            case "raise":
                raise ValueError("no air\nanywhere")
            case "lose its mass":
                mass[scenes.index(where)] = math.nan
                taps.deliver("mass", "planner.thrust", Reading(mass, "mass", 0), 0)
            case "write":
                got = taps.deliver("mass", "planner.thrust", Reading(mass, "mass", 0), 0)
                got *= 2.0
        outcomes = super().run(variant, scenes, taps, seed)
        changes = WRONG.get(does, {})
        if callable(changes):
            return changes(outcomes)
        return [replace(o, **changes) if o.scene == where else o for o in outcomes]


def unruly(**options: str) -> Unruly:
    return Unruly(**options)


def bounded(**options: str) -> Unruly:
    """Build one that says itself how long."""
    system = Unruly(**options)
    system.time_limit_s = 2.0
    return system


def slow_worker(parent: str) -> ToySystem:
    """Build the system in the process `parent`, and wait for ever in any other."""
    if os.getpid() != int(parent):
        time.sleep(600)
    return ToySystem()


UNRULY = f"{__file__}:unruly"


@pytest.mark.parametrize(
    ("factory", "scenes", "limits", "limit"),
    [("unruly", SCENES[5:6], {"time_limit_s": 0.5}, 0.5), ("bounded", SCENES[4:6], {}, 2)],
)
def test_a_scene_that_takes_too_long_loses_itself_alone(tmp_path, factory, scenes, limits, limit):
    trials = plan_of(f"{__file__}:{factory}", scenes, does="hang", where="s05")
    (failure,) = run_plan(trials, tmp_path, workers=1, **limits).failures
    assert failure.scene == "s05"
    assert f"stopped at the time limit of {limit} s" in failure.error


@pytest.mark.parametrize(("workers", "status"), [(0, "0"), (1, "1")])
def test_a_system_that_exits_has_failed(tmp_path, workers, status):
    trials = plan_of(UNRULY, SCENES[:8], does="exit", where="s05", status=status)
    (failure,) = run_plan(trials, tmp_path, workers=workers).failures
    assert failure.scene == "s05"
    assert f"called sys.exit({status})" in failure.error


@pytest.mark.parametrize(("workers", "does"), [(0, "exit"), (1, "raise")])
def test_a_system_that_fails_everywhere_is_stopped_after_a_few(tmp_path, does, workers):
    trials = plan_of(UNRULY, count=12, does=does, status="0")
    with pytest.raises(UserError, match=f"all of the first {FEW} trials failed") as caught:
        run_plan(trials, tmp_path / "run", workers=workers)
    said = str(caught.value)
    assert ("ValueError: no air anywhere" if does == "raise" else "sys.exit(0)") in said
    assert "\n" not in said
    (named,) = (f for f in (tmp_path / "run" / "failures").iterdir() if str(f) in said)
    assert "Traceback" in named.read_text()
    assert not (tmp_path / "run" / "outcomes.parquet").exists()


def test_a_system_that_is_never_built_in_a_worker_is_not_waited_for(tmp_path, monkeypatch):
    monkeypatch.setattr(dispatch, "LEAST_S", 0.25)
    trials = plan_of(f"{__file__}:slow_worker", parent=str(os.getpid()))
    with pytest.raises(UserError, match=r"was not built in a worker process within 0\.5 s: look"):
        run_plan(trials, tmp_path, workers=1, time_limit_s=0.5)


@pytest.mark.parametrize(
    ("wrong", "workers"),
    [("distance", 0), ("status", 0), ("object", 1), ("surrogate", 0), ("error", 0)],
)
def test_a_malformed_outcome_fails_its_trial_alone(tmp_path, wrong, workers):
    trials = plan_of(UNRULY, does=wrong, where="s05")
    result = run_plan(trials, tmp_path, workers=workers)
    statuses = {row.outcome.scene: row.outcome.status for row in result.trials}
    assert [scene for scene in SCENES if statuses[scene] is Status.FAILED] == ["s05"]
    (failure,) = result.failures
    assert failure.error
    assert failure.error in failure.details.read_text()
    assert run_plan(trials, tmp_path, workers=0).outcomes_sha256 == result.outcomes_sha256


@pytest.mark.parametrize(
    ("wrong", "said", "workers"),
    [("nothing", "a NoneType", 1), ("dict", "a dict in place of", 0), ("order", "in order", 0)],
)
def test_no_outcomes_at_all_stop_the_run(tmp_path, wrong, said, workers):
    with pytest.raises(SystemMistake, match=said):
        run_plan(plan_of(UNRULY, does=wrong), tmp_path, workers=workers)


def test_a_reading_that_is_no_number_costs_its_scene_alone(tmp_path):
    trials = plan_of(UNRULY, SCENES[4:8], does="lose its mass", where="s05")
    (failure,) = run_plan(trials, tmp_path, workers=0).failures
    assert failure.scene == "s05"
    assert "tap mass -> planner.thrust: the first reading is not finite" in failure.error


def test_a_reader_that_writes_is_told_to_copy(tmp_path):
    result = run_plan(plan_of(UNRULY, SCENES[4:8], does="write"), tmp_path, workers=0)
    assert len(result.failures) == 4
    assert "what a tap delivers cannot be written to" in result.failures[0].error


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("undisturbed")
    run_plan(plan(), folder, workers=0)
    return folder


def test_a_scene_that_fails_loses_itself_alone(undisturbed, tmp_path):
    result = run_plan(plan(raises="s05"), tmp_path, workers=0)
    sound = run_plan(plan(), undisturbed, workers=0)
    for row, expected in zip(result.trials, sound.trials, strict=True):
        if row.outcome.scene == "s05":
            assert row.outcome.failed
            assert row.outcome.error == "ValueError: no air in s05"
        else:
            assert row.outcome.metrics == expected.outcome.metrics
    (planner,) = result.deliveries.at("plain", "correct")
    assert planner.deliveries == 2 * ToySystem.steps * (len(SCENES) - 1)
    assert len(result.failures) == len(plan().treatments())
    for failure in result.failures:
        assert failure.scene == "s05"
        text = failure.details.read_text()
        assert 'raise ValueError(f"no air in' in text
        assert '"variant":' in text


def test_a_worker_that_dies_once_costs_nothing(undisturbed, tmp_path):
    once, log = tmp_path / "died", tmp_path / "log"
    mortal = plan(dies="s05", once=str(once), log=str(log))
    result = run_plan(mortal, tmp_path / "run", workers=2, recheck=False)
    assert len(log.read_text().splitlines()) == UNITS + 1  # its block ran again, as a whole
    assert not result.failures
    for name in ("outcomes.parquet", "traces.parquet"):
        assert (tmp_path / "run" / name).read_bytes() == (undisturbed / name).read_bytes()


def test_a_scene_that_kills_its_worker_loses_itself_alone(tmp_path):
    result = run_plan(plan_of(SYSTEM, dies="s05"), tmp_path, workers=1)
    assert [trial.outcome.scene for trial in result.trials if trial.outcome.failed] == ["s05"]
    (failure,) = result.failures
    assert "SIGKILL" in failure.error
    assert "SIGKILL" in failure.details.read_text()


def test_a_system_that_takes_one_scene_at_a_time_is_found_again_by_the_second_call(tmp_path):
    for computed in (UNITS, 0):
        result = run_plan(plan(alone="plain"), tmp_path / "run", workers=0, recheck=False)
        assert result.blocks_computed == computed
        assert not result.failures
        (finding,) = (f for f in map(describe, result.findings) if "when each ran alone" in f)
        assert "the truth value of an array is ambiguous" in finding
        assert f" of {UNITS} blocks" in finding
