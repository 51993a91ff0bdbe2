"""LeRobot's relative actions: an error of the joints cancels where both readers have it."""

from importlib import import_module
from pathlib import Path

import pytest

pytest.importorskip("torch")

import torch

from faultpath import audit

ROOT = Path(__file__).resolve().parents[2]
FAULT = "joints:offset=0.1/0.1/0.1"
STATE = "observation.state"


@pytest.fixture(scope="module")
def example():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "examples"))
        yield import_module(Path("lerobot_relative_actions.py").stem)


@pytest.fixture
def copy(example):
    return import_module(Path("lerobot_steps.py").stem)


def relative_and_absolute(package, **settings):
    """Return relative actions and those that come back, of the steps of a package."""
    draws = torch.Generator().manual_seed(0)
    state, actions = torch.randn(2, 3, generator=draws), torch.randn(2, 4, 3, generator=draws)
    relative = package.RelativeActionsProcessorStep(enabled=True, **settings)
    absolute = package.AbsoluteActionsProcessorStep(enabled=True, relative_step=relative)
    moved = relative({"observation": {STATE: state}, "action": actions})["action"]
    return state, actions, moved, absolute({"action": moved})["action"]


def test_what_is_taken_off_is_added_back(copy):
    state, actions, moved, back = relative_and_absolute(copy)
    assert torch.equal(moved, actions - state[:, None])
    assert torch.allclose(back, actions)


@pytest.mark.parametrize("excluded", [[], ["gripper"], ["Shoulder", "grip"]])
def test_the_copy_computes_what_lerobot_does(copy, excluded):
    lerobot = pytest.importorskip("lerobot.processor")
    names = {"exclude_joints": excluded, "action_names": ["shoulder.pos", "elbow.pos", "gripper"]}
    for ours, theirs in zip(
        relative_and_absolute(copy, **names), relative_and_absolute(lerobot, **names), strict=True
    ):
        assert torch.equal(ours, theirs)


def test_a_state_that_was_not_kept_is_told(copy):
    absolute = copy.AbsoluteActionsProcessorStep(True, copy.RelativeActionsProcessorStep(True))
    with pytest.raises(RuntimeError, match="no state"):
        absolute({"action": torch.zeros(1, 3)})


def test_a_shared_offset_cancels_and_the_repair_loses_that(example):
    run = audit(
        example.create(),
        baseline="encoders",
        repair="camera",
        fault=FAULT,
        library="training",
        scenes=20,
        workers=0,
    )
    effects = {effect.path: effect for effect in run.record.effects}
    assert set(effects) == {"correct", "conversion", "policy", "shared"}
    assert effects["policy"].success.value == 100
    assert effects["shared"].success.value == -100
    turns = {change.isolated: change.turn for change in run.record.changes}
    assert turns["policy"] == "reversal"
