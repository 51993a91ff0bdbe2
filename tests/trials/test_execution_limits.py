"""What a system that hangs, exits or fails everywhere may cost."""

import math
import os
import sys
import time

import pytest
from toy_study import SCENES, study
from toy_system import ToySystem

from faultpath.core.errors import UserError
from faultpath.trials.execution import dispatch
from faultpath.trials.execution.runner import run_study
from faultpath.trials.execution.state import FEW


class Unruly(ToySystem):
    """Does one unruly thing, in one scene or in all."""

    def run(self, variant, scenes, taps, seed):
        options = self._options
        if "where" not in options or options["where"] in scenes:
            match options["does"]:
                case "hang":
                    time.sleep(600)
                case "exit":
                    sys.exit(int(options["status"]))
                case "raise":
                    raise ValueError("no air\nanywhere")
        return super().run(variant, scenes, taps, seed)


def unruly(**options: str) -> Unruly:
    return Unruly(**options)


def bounded(**options: str) -> Unruly:
    """Build one that says itself how long."""
    system = Unruly(**options)
    system.time_limit_s = 3.0
    return system


def slow_worker(parent: str) -> ToySystem:
    """Build the system in the process `parent`, and wait for ever in any other."""
    if os.getpid() != int(parent):
        time.sleep(600)
    return ToySystem()


def _study(scenes: tuple[str, ...] = SCENES, rows: int = 1, **options: str):
    asked = study(scenes, **options)
    system = asked.system.model_copy(update={"name": f"{__file__}:unruly"})
    return asked.model_copy(update={"system": system, "rows": asked.rows[:rows]})


def _failed(result) -> list[str]:
    return [failure.scene for failure in result.failures]


@pytest.mark.parametrize("says", ["user", "system"])
def test_a_scene_that_takes_too_long_loses_itself_alone(tmp_path, says):
    asked = _study(SCENES[4:6], does="hang", where="s05")
    limits = {"time_limit_s": 3.0}
    if says == "system":
        system = asked.system.model_copy(update={"name": f"{__file__}:bounded"})
        asked, limits = asked.model_copy(update={"system": system}), {}
    result = run_study(asked, tmp_path, workers=1, **limits)
    assert _failed(result) == ["s05"]
    assert "stopped at the time limit of 3 s" in result.failures[0].error


def test_this_process_cannot_stop_itself(tmp_path):
    with pytest.raises(UserError, match="needs worker processes"):
        run_study(study(), tmp_path, workers=0, time_limit_s=10.0)


@pytest.mark.parametrize(("workers", "status"), [(0, "0"), (1, "1")])
def test_a_system_that_exits_has_failed(tmp_path, workers, status):
    asked = _study(SCENES[:8], does="exit", where="s05", status=status)
    result = run_study(asked, tmp_path, workers=workers)
    assert _failed(result) == ["s05"]
    assert f"called sys.exit({status})" in result.failures[0].error


@pytest.mark.parametrize(("workers", "does"), [(0, "exit"), (2, "raise")])
def test_a_system_that_fails_everywhere_is_stopped_after_a_few(tmp_path, does, workers):
    asked = _study(rows=12, does=does, status="0")
    with pytest.raises(UserError, match=f"all of the first {FEW} trials failed") as caught:
        run_study(asked, tmp_path / "run", workers=workers)
    said = str(caught.value)
    assert ("ValueError: no air anywhere" if does == "raise" else "sys.exit(0)") in said
    assert "\n" not in said
    (named,) = (f for f in (tmp_path / "run" / "failures").iterdir() if str(f) in said)
    assert "Traceback" in named.read_text()


def test_one_trial_that_ran_is_enough_to_go_on(tmp_path):
    result = run_study(study(raises="s05"), tmp_path, workers=0)
    assert len(result.failures) > FEW


@pytest.mark.parametrize("wrong", [0.0, math.nan, math.inf])
def test_a_limit_that_is_none_is_refused(tmp_path, wrong):
    with pytest.raises(UserError, match="time limit"):
        run_study(study(), tmp_path, workers=1, time_limit_s=wrong)


def test_a_system_that_is_never_built_in_a_worker_is_not_waited_for(tmp_path, monkeypatch):
    monkeypatch.setattr(dispatch, "LEAST_S", 1.0)
    asked = study(parent=str(os.getpid()))
    system = asked.system.model_copy(update={"name": f"{__file__}:slow_worker"})
    asked = asked.model_copy(update={"system": system})
    with pytest.raises(UserError, match=r"was not built in a worker process within 2 s: look"):
        run_study(asked, tmp_path, workers=1, time_limit_s=2.0)
