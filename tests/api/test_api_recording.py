"""After an audit: signals of the scenes that its report begins with, never an error."""

import shutil
from importlib import import_module

import numpy as np
import pytest
from toy_audits import AUDIT, FILE
from written import written

import faultpath
from faultpath.api.folders import read_run
from faultpath.run.store.signals import SIGNALS, TOGETHER

AUDIT_MODULE = import_module("faultpath.api.audit")
QUESTION = AUDIT | {"scenes": 3}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return faultpath.audit(FILE, **QUESTION, folder=tmp_path_factory.mktemp("recorded") / "run")


def test_signals_of_the_first_scene_are_there_without_being_asked_for(run) -> None:
    recorded = read_run(run.folder).signals
    assert len({at.scene for at in recorded}) == 1
    conditions = ("correct", "controller", "observer", "shared")
    variants = {
        (variant, condition) for variant in ("calibrated", "blind") for condition in conditions
    }
    assert {(at.variant, at.condition) for at in recorded} == variants


def test_two_errors_add_up_to_what_the_acceleration_differs_by(run) -> None:
    for at, named in read_run(run.folder).signals.items():
        value = {each.name: each.values[:, 0].astype(float) for each in named}
        expected = value["goal"] - value["odometer"] - 2.0 * value["speedometer"]
        actual = np.diff(value["speedometer"], append=np.nan) / 0.1
        assert np.allclose(value[TOGETHER], expected - actual, atol=1e-5, equal_nan=True), at
        gain, slope = value["controller: wrong gain"], value["observer: wrong slope"]
        assert np.allclose(gain + slope, value[TOGETHER], atol=1e-6, equal_nan=True)
        assert gain.any() == (at.condition in ("controller", "shared"))


def test_a_second_call_runs_nothing_again_and_completes_what_is_missing(
    run, tmp_path, monkeypatch
) -> None:
    place = tmp_path / "run"
    shutil.copytree(run.folder, place)
    kept = (place / SIGNALS).read_bytes()
    with monkeypatch.context() as without:
        without.setattr(AUDIT_MODULE, "run_again", None)
        again = faultpath.audit(FILE, **QUESTION, folder=place)
    assert (place / SIGNALS).read_bytes() == kept
    assert SIGNALS in again.provenance.files
    (place / SIGNALS).unlink()  # as where a run was killed before they were written
    faultpath.audit(FILE, **QUESTION, folder=place)
    assert (place / SIGNALS).read_bytes() == kept


def test_a_stop_while_signals_are_recorded_leaves_a_finished_audit(tmp_path, monkeypatch) -> None:
    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(AUDIT_MODULE, "run_again", stopped)
    run = faultpath.audit(FILE, **QUESTION, folder=tmp_path / "run")
    assert (run.folder / "report.html").is_file()
    assert not (run.folder / SIGNALS).exists()
    assert not run.words.findings


@pytest.mark.parametrize("second", ["raises", "ends", "differs"])
def test_a_system_that_does_not_run_again_is_a_finding(tmp_path, second) -> None:
    """It runs each variant twice at most as the run asks; with listening taps it is another
    one."""
    what = {
        "raises": "raise RuntimeError('not again')",
        "ends": "import sys; sys.exit(3)",
        "differs": "outcomes = [replace(o, time_s=o.time_s / 2) for o in outcomes]",
    }[second]
    system = written(
        tmp_path,
        "def run(self, variant, scenes, taps, seed):\n"
        "    outcomes = super().run(variant, scenes, taps, seed)\n"
        f"    if taps._observer is not None:\n        {what}\n"
        "    return outcomes",
    )
    run = faultpath.audit(system, **QUESTION, folder=tmp_path / "run")
    assert not (run.folder / SIGNALS).exists()
    finding = next(each for each in run.words.findings if "signals" in each.lower())
    assert {"raises": "not again", "ends": "sys.exit(3)", "differs": "time_s"}[second] in finding
    assert finding in (run.folder / "report.html").read_text("utf-8").replace("&#39;", "'")
