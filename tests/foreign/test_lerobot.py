"""LeRobot's relative actions: an error of the joints cancels where both readers have it."""

import sys
from base64 import urlsafe_b64encode
from functools import partial
from hashlib import sha256
from importlib import import_module
from importlib.metadata import files
from importlib.util import find_spec
from pathlib import Path

import pytest

pytest.importorskip("torch")

import torch
from foreign_trials import imported
from pyarrow.parquet import read_table

from faultpath import audit

FAULT = "joints:offset=0.1/0.1/0.1"
STATE = "observation.state"
NAMES = ["shoulder.pos", "elbow.pos", "Gripper", "wrist.pos"]


@pytest.fixture(scope="module")
def lerobot():
    """LeRobot's own classes: the package `lerobot.processor`."""
    if find_spec("lerobot") is None:  # importing it takes what the module below knows
        pytest.skip("LeRobot is not installed: make test-foreign runs this in .venv-lerobot")
    return import_module("lerobot_processor").processor()


def example_on(patch, classes):
    """Return the example, imported anew with these classes; without any it takes the copy."""
    patch.setitem(sys.modules, "lerobot.processor", classes)
    patch.delitem(sys.modules, "lerobot_relative_actions", raising=False)
    return imported(patch, "lerobot_relative_actions.py")


@pytest.fixture
def copy(monkeypatch):
    return imported(monkeypatch, "lerobot_steps.py")


def flown(example, **settings):
    return audit(
        example.create(), baseline="encoders", repair="camera", fault=FAULT, workers=0, **settings
    )


def relative_and_absolute(package, state, actions, **settings):
    """Return relative actions and those that come back, of the steps of a package."""
    relative = package.RelativeActionsProcessorStep(enabled=True, **settings)
    absolute = package.AbsoluteActionsProcessorStep(enabled=True, relative_step=relative)
    moved = relative({"observation": {STATE: state}, "action": actions})["action"]
    return moved, absolute({"action": moved})["action"]


def test_what_is_taken_off_is_added_back(copy):
    draws = torch.Generator().manual_seed(0)
    state, actions = torch.randn(2, 3, generator=draws), torch.randn(2, 4, 3, generator=draws)
    moved, back = relative_and_absolute(copy, state, actions)
    assert torch.equal(moved, actions - state[:, None])
    assert torch.allclose(back, actions)


def test_the_file_of_the_two_classes_is_that_of_the_release(lerobot):
    name = "lerobot/processor/relative_action_processor.py"
    (file,) = (file for file in files("lerobot") or () if str(file) == name)
    path = Path(sys.modules[lerobot.RelativeActionsProcessorStep.__module__].__file__ or "")
    assert path == Path(file.locate())
    digest = urlsafe_b64encode(sha256(path.read_bytes()).digest()).decode().rstrip("=")
    assert file.hash
    assert digest == file.hash.value


@pytest.mark.parametrize("excluded", [[], ["gripper"], ["Shoulder", "grip", ""]])
@pytest.mark.parametrize("names", [None, NAMES[:2], NAMES])
@pytest.mark.parametrize("shape", [(8, 4), (8, 16, 4), (1, 1, 4)])
def test_the_copy_computes_what_lerobot_does(lerobot, copy, shape, names, excluded):
    settings = {"exclude_joints": excluded, "action_names": names}
    draws = torch.Generator().manual_seed(0)
    for dtype in (torch.float32, torch.float64) * 20:
        state = torch.randn(shape[0], 4, generator=draws, dtype=dtype)
        actions = torch.randn(shape, generator=draws)
        ours = relative_and_absolute(copy, state, actions, **settings)
        theirs = relative_and_absolute(lerobot, state, actions, **settings)
        assert all(map(torch.equal, ours, theirs))


def test_a_state_that_was_not_kept_is_told(copy):
    absolute = copy.AbsoluteActionsProcessorStep(True, copy.RelativeActionsProcessorStep(True))
    with pytest.raises(RuntimeError, match="no state"):
        absolute({"action": torch.zeros(1, 3)})


def test_an_audit_on_lerobots_classes_has_the_bits_of_one_on_the_copy(lerobot, tmp_path):
    weights = None
    for name, classes in (("copy", None), ("lerobot", lerobot)):
        with pytest.MonkeyPatch.context() as patch:
            example = example_on(patch, classes)
            theirs = example.RelativeActionsProcessorStep is lerobot.RelativeActionsProcessorStep
            assert theirs == (name == "lerobot")
            # The last bits of a fit depend on where its arrays lie in memory: both take one.
            weights = example.fitted() if weights is None else weights
            patch.setattr(example, "fitted", partial(torch.clone, weights))
            flown(example, folder=tmp_path / name, scenes=20)
    for name in ("outcomes.parquet", "signals.parquet"):
        ours, theirs = (read_table(tmp_path / folder / name) for folder in ("copy", "lerobot"))
        assert ours.num_rows
        assert ours.equals(theirs), name


def test_a_shared_offset_cancels_and_the_repair_loses_that(monkeypatch):
    example = example_on(monkeypatch, None)
    record = flown(example, library="training", scenes=20).record
    effects = {effect.condition: effect for effect in record.effects}
    assert set(effects) == {"correct", "conversion", "policy", "shared"}
    assert effects["policy"].value == 100
    assert effects["shared"].value == -100
    turns = {change.isolated: change.turn for change in record.changes}
    assert turns["policy"] == "reversal"
