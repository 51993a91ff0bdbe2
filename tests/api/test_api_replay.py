"""Trials of a finished run, run again: the same to the bit, recorded, and in the report."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from toy_audits import AUDIT, TOY

import faultpath
from faultpath.api.folders import read_run
from faultpath.api.replaying import chosen_scenes, keep_signals, replay, where_parted
from faultpath.cli.replay import replay as command
from faultpath.core.errors import UserError
from faultpath.run.findings import Deviation
from faultpath.run.store.signals import IN_FORCE, SIGNALS, Signal
from faultpath.run.store.tables import TrialAddress
from faultpath.run.trials import Trials

SCENE = "cart/001"
QUESTION = AUDIT | {"fault": "gain:scale=0.6,onset=20,for=30", "scenes": 3}


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("replay") / "run"
    faultpath.audit(TOY, **QUESTION, folder=place, signals=False)
    return place


@pytest.fixture(scope="module")
def trials(folder):
    return replay(read_run(folder), (SCENE,), trust=True).trials


def _signals(trials, variant: str, condition: str) -> dict[str, Signal]:
    address = TrialAddress(variant, condition, 0, SCENE)
    return {s.name: s for each in trials if each.address == address for s in each.signals}


def test_a_replay_is_the_run_and_hears_what_the_fault_did(trials) -> None:
    assert len(trials) == 8
    assert not any(each.deviation for each in trials)
    signals = _signals(trials, "calibrated", "shared")
    gain = signals["gain_estimate"].values
    assert gain.shape == (100, 1)
    faulted = np.zeros((100, 1))
    faulted[20:50] = 1
    assert np.array_equal(signals[IN_FORCE].values, faulted)
    for tap in ("controller.inverse", "observer.model"):
        assert np.allclose(signals[f"gain at {tap}"].values, gain * (1 - 0.4 * faulted))
        assert np.allclose(signals[f"gain error at {tap}"].values, -0.4 * gain * faulted)
    assert signals["observed_slope"].topic == "slope"
    assert np.isfinite(signals["observed_slope"].values).all()
    assert "gain at observer.model" not in _signals(trials, "blind", "shared")
    assert IN_FORCE not in _signals(trials, "blind", "correct")


def test_signals_stay_with_the_run_and_a_changed_file_is_refused(folder, trials, tmp_path) -> None:
    run = tmp_path / "run"
    shutil.copytree(folder, run)
    source = read_run(run)
    few = [each for each in trials if each.address.condition == "shared"]
    written = keep_signals(run, source, few)
    assert written[0] == run / SIGNALS
    more = read_run(run)
    assert len(more.signals) == 2
    keep_signals(run, more, trials)
    assert len(read_run(run).signals) == 8
    (run / SIGNALS).write_bytes((run / SIGNALS).read_bytes()[:-1] + b"x")
    with pytest.raises(UserError, match=r"signals.parquet changed since the run"):
        read_run(run)


def test_a_trial_that_comes_out_otherwise_is_told_and_not_heard(folder) -> None:
    source = read_run(folder)
    rows = tuple(
        replace(row, outcome=replace(row.outcome, time_s=9.0)) if row.condition == "shared" else row
        for row in source.trials
    )
    changed = replace(source, trials=Trials.of(rows))
    trials = replay(changed, (SCENE,), ("shared", "observer"), trust=True).trials
    differs = {trial.address.condition: bool(trial.deviation) for trial in trials}
    assert differs == {"shared": True, "observer": False}
    for trial in trials:
        assert ("time_s by up to 1" in str(trial.deviation)) == bool(trial.deviation)
        assert bool(trial.signals) != bool(trial.deviation)


def test_only_scenes_and_conditions_of_a_run_that_can_be_built_are_run_again(folder) -> None:
    source = read_run(folder)
    assert len(chosen_scenes(source, (), ())) == 3
    assert chosen_scenes(source, (SCENE, SCENE), ("shared",)) == (SCENE,)
    with pytest.raises(UserError, match=r"unknown scene"):
        chosen_scenes(source, ("cart/09",), ())
    with pytest.raises(UserError, match=r"unknown condition"):
        chosen_scenes(source, (), ("both",))
    facts = source.record.facts.model_copy(update={"system": "Toy object"})
    lost = replace(source, record=source.record.model_copy(update={"facts": facts}))
    with pytest.raises(UserError, match="is of a Toy object, which only its own process had"):
        replay(lost, (SCENE,), trust=True)


def test_the_verb_says_whether_a_run_repeats(folder, capsys) -> None:
    assert command(folder, trust=True, scene=[SCENE], condition=["observer"]) == 0
    assert "2 trials in 1 scene came out as in the run, to the bit." in capsys.readouterr().out


def test_the_verb_says_where_versions_and_conditions_part(folder, capsys) -> None:
    one = {"trust": True, "scene": [SCENE], "where": True}
    assert command(folder, **one, condition=["shared"]) == 0
    printed = capsys.readouterr()
    text = " ".join(printed.out.split())
    begin = f"{SCENE}, seed 0, shared, calibrated and blind: At 0.10 s the slope that the"
    assert (text.count(", seed 0, "), printed.err.count(", seed 0, again: ")) == (1, 2)
    assert f"{begin} controller reads is" in text
    assert command(folder, **one, condition=["correct", "shared"], as_json=True) == 0
    partings = json.loads(capsys.readouterr().out)
    couples = [[(t["variant"], t["condition"]) for t in of["trials"]] for of in partings]
    assert couples == [
        [("calibrated", "correct"), ("blind", "correct")],
        [("calibrated", "shared"), ("blind", "shared")],
        [("calibrated", "correct"), ("calibrated", "shared")],
        [("blind", "correct"), ("blind", "shared")],
    ]
    onset = partings[2]["first"]["reading"]
    assert (onset["step"], onset["name"], onset["delivered"]) == (20, "gain", True)
    assert onset["values"][1] == pytest.approx(0.6 * onset["values"][0])
    assert partings[2]["first"]["state"]["step"] == 21
    with pytest.raises(UserError, match="give --where too"):
        command(folder, trust=True, as_json=True)


def test_trials_that_came_out_otherwise_are_not_compared(folder, trials) -> None:
    source = read_run(folder)
    other = Deviation(scenes=(SCENE,), of=1, gaps=(("time_s", 1.0),))
    unlike = [replace(trials[0], deviation=other), *trials[1:]]
    first = unlike[0].address
    left = where_parted(source, unlike, [SCENE])
    assert len(left) == 3
    assert first.condition not in {end.condition for of in left for end in of.trials}


@pytest.mark.parametrize(
    ("update", "words"),
    [
        ({}, ()),
        ({"machine": {"processor": "Abacus"}}, ("the processor (Abacus, here ",)),
        ({"machine": {"backend": "stones"}}, ("what computes (stones, here )",)),
        ({"machine": {"python": "2.7.18"}}, ("Python (2.7.18, here ",)),
        ({"code": {"sources": {}}}, ("files (",)),
    ],
)
def test_a_replay_says_what_has_changed_since_the_run(folder, update, words) -> None:
    source = read_run(folder)
    run = source.provenance
    parts = {name: getattr(run, name).model_copy(update=part) for name, part in update.items()}
    run = run.model_copy(update=parts)
    changed = replay(replace(source, provenance=run), (SCENE,), ("observer",), trust=True).changed
    assert len(changed) == len(words)
    assert all(map(str.startswith, changed, words))


def test_signals_that_cannot_be_written_are_refused_before_trials_run(
    folder, tmp_path, monkeypatch
) -> None:
    run = Path(shutil.copytree(folder, tmp_path / "run"))
    (run / SIGNALS).mkdir()
    monkeypatch.setattr("faultpath.api.replaying.replay", lambda *_: 1 / 0)
    with pytest.raises(UserError, match=r"signals\.parquet \(it is a folder"):
        command(run, signals=True, trust=True)
