"""Trials of a finished run flown again: the same to the bit, heard, and in the report."""

import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import faultpath
from faultpath.api.folders import read_run
from faultpath.api.replaying import chosen_scenes, keep_signals, replay
from faultpath.cli.replay import replay as command
from faultpath.core.errors import UserError
from faultpath.trials.store.mcap import encode_mcap
from faultpath.trials.store.signals import IN_FORCE, SIGNALS, Signal
from faultpath.trials.store.tables import TrialAddress

TOY = f"{Path(__file__).resolve().parents[2] / 'examples' / 'toy.py'}:create"
SCENE = "cart/001"
AUDIT = {
    "baseline": "calibrated",
    "repair": "blind",
    "fault": "gain:scale=0.6,onset=20,for=30",
    "library": "carts",
    "scenes": 3,
    "workers": 0,
    "progress": False,
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("replay") / "run"
    faultpath.audit(TOY, **AUDIT, folder=place, signals=False)
    return place


@pytest.fixture(scope="module")
def found(folder):
    return replay(read_run(folder)[0], (SCENE,), trust=True)


def _signals(found, variant: str, path: str) -> dict[str, Signal]:
    address = TrialAddress(variant, path, 0, SCENE)
    return {s.name: s for each in found if each.address == address for s in each.signals}


def test_a_replay_is_the_run_and_hears_what_the_fault_did(found) -> None:
    assert len(found) == 8
    assert not any(each.differs for each in found)
    heard = _signals(found, "calibrated", "shared")
    gain = heard["gain_estimate"].values
    assert gain.shape == (100, 1)
    faulted = np.zeros((100, 1))
    faulted[20:50] = 1
    assert np.array_equal(heard[IN_FORCE].values, faulted)
    for tap in ("controller.inverse", "observer.model"):
        assert np.allclose(heard[f"gain at {tap}"].values, gain * (1 - 0.4 * faulted))
        assert np.allclose(heard[f"gain error at {tap}"].values, -0.4 * gain * faulted)
    assert heard["observed_slope"].topic == "slope"
    assert np.isfinite(heard["observed_slope"].values).all()
    assert "gain at observer.model" not in _signals(found, "blind", "shared")
    assert IN_FORCE not in _signals(found, "blind", "correct")


def test_signals_stay_with_the_run_and_a_changed_file_is_refused(folder, found, tmp_path) -> None:
    run = tmp_path / "run"
    shutil.copytree(folder, run)
    held, _ = read_run(run)
    few = [each for each in found if each.address.path == "shared"]
    written = keep_signals(run, held, few)
    assert written[0] == run / SIGNALS
    more = read_run(run)[0]
    assert len(more.signals) == 2
    keep_signals(run, more, found)
    assert len(read_run(run)[0].signals) == 8
    (run / SIGNALS).write_bytes((run / SIGNALS).read_bytes()[:-1] + b"x")
    with pytest.raises(UserError, match=r"signals.parquet changed since the run"):
        read_run(run)


def test_exported_signals_are_read_back_equal(folder, found, tmp_path, capsys, monkeypatch) -> None:
    reader = pytest.importorskip("mcap.reader", reason="the extra mcap is not installed")
    to = tmp_path / "run.mcap"
    assert command(folder, trust=True, scene=[SCENE], path=["shared"], export=to) == 0
    assert f"Written: {to}" in capsys.readouterr().out
    back: dict[tuple[str, str], list[np.ndarray]] = {}
    with to.open("rb") as file:
        for _, channel, message in reader.make_reader(file).iter_messages():
            rows = back.setdefault((channel.metadata["variant"], channel.metadata["signal"]), [])
            assert message.log_time == round(len(rows) * 0.1 * 1e9)
            rows.append(np.frombuffer(message.data, "<f4", offset=4))
    kept = {v: _signals(found, v, "shared") for v in ("calibrated", "blind")}
    assert set(back) == {(variant, name) for variant, named in kept.items() for name in named}
    for (variant, name), rows in back.items():
        assert np.array_equal(np.stack(rows), kept[variant][name].values, equal_nan=True), name
    with pytest.raises(UserError, match="is there already"):
        command(folder, trust=True, scene=[SCENE], export=to)
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with pytest.raises(UserError, match=r"pip install '\.\[mcap\]'"):
        command(folder, trust=True, scene=[SCENE], export=tmp_path / "other.mcap")


def test_topics_and_components_have_names_that_ros_takes(tmp_path) -> None:
    """As rosbags finds them: what is no name there, or stands twice, is numbered."""
    pytest.importorskip("mcap", reason="the extra mcap is not installed")
    highlevel = pytest.importorskip("rosbags.highlevel", reason="the extra bags is not installed")
    values, numbered = np.array([[1, np.nan], [3, 4]], np.float32), ["component_1", "component_2"]
    parts = {"wind at a.b": ("East wind", "north"), "twice": ("a", "A"), "digit": ("1", "b")}
    signals = tuple(Signal(name, name, "m/s", values, each) for name, each in parts.items())
    address = TrialAddress("a+b", "p q", 1, "s/1")
    (tmp_path / "x.mcap").write_bytes(encode_mcap({address: signals}, 0.1))
    fields = {"wind@a/b": ["east_wind", "north"], "twice": numbered, "digit": numbered}
    found: dict[str, list[list[float]]] = {}
    with highlevel.AnyReader([tmp_path / "x.mcap"]) as bag:
        for connection, _, raw in bag.messages():
            name = connection.topic.removeprefix("/a+b/p_q/seed_1/s/1/")
            told = bag.deserialize(raw, connection.msgtype)
            found.setdefault(name, []).append([getattr(told, field) for field in fields[name]])
    assert found.keys() == fields.keys()
    for rows in found.values():
        assert np.array_equal(np.array(rows, np.float32), values, equal_nan=True)


def test_a_trial_that_comes_out_otherwise_is_told_and_not_heard(folder) -> None:
    held, _ = read_run(folder)
    rows = tuple(
        replace(row, outcome=replace(row.outcome, time_s=9.0)) if row.path == "shared" else row
        for row in held.outcomes.rows
    )
    changed = replace(held, outcomes=replace(held.outcomes, rows=rows))
    found = replay(changed, (SCENE,), ("shared", "observer"), trust=True)
    assert {each.address.path: bool(each.differs) for each in found} == {
        "shared": True,
        "observer": False,
    }
    for each in found:
        assert ("time_s by up to 1" in each.differs) == bool(each.differs)
        assert bool(each.signals) != bool(each.differs)


def test_scenes_and_paths_are_those_of_the_run(folder) -> None:
    held, _ = read_run(folder)
    assert len(chosen_scenes(held, (), ())) == 3
    assert chosen_scenes(held, (SCENE, SCENE), ("shared",)) == (SCENE,)
    with pytest.raises(UserError, match=r"unknown scene"):
        chosen_scenes(held, ("cart/09",), ())
    with pytest.raises(UserError, match=r"unknown path"):
        chosen_scenes(held, (), ("both",))


def test_an_object_cannot_be_flown_again(folder) -> None:
    held, _ = read_run(folder)
    question = held.record.question.model_copy(update={"system": "Toy object"})
    lost = replace(held, record=held.record.model_copy(update={"question": question}))
    with pytest.raises(UserError, match="is of a Toy object, which only its own process had"):
        replay(lost, (SCENE,), trust=True)


def test_the_verb_says_whether_a_run_repeats(folder, capsys) -> None:
    assert command(folder, trust=True, scene=[SCENE], path=["observer"]) == 0
    assert "2 trials in 1 scene came out as in the run, to the bit." in capsys.readouterr().out
