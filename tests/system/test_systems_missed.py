"""A fault that reaches nobody, changes nothing or is ignored is told from one that does no harm."""

from pathlib import Path

import pytest

import faultpath
from faultpath.system import ComposedSystem, writes
from faultpath.system.gymnasium import GymnasiumPlant

pytestmark = pytest.mark.usefixtures("without_pages")
PAGE = (Path(__file__).resolve().parents[2] / "docs" / "torch.md").read_text("utf-8")
POLE = slice(2, 4)


@writes("push")
def agent(cart, pole):
    """Balance by the cart alone: the pole is handed over and not used."""
    return (cart[:, 1] < 0).astype(int)


@writes("push")
def other(pole):
    return (pole[:, 0] > 0).astype(int)


@pytest.fixture(scope="module")
def system() -> ComposedSystem:
    plant = GymnasiumPlant(
        "CartPole-v1",
        observes={"cart": slice(0, 2), "pole": POLE, "copy": POLE},
        action="push",
        steps=60,
        dt_s=0.02,
        succeeded=lambda episode: not episode.terminated,
    )
    units = {"cart": "m, m/s", "pole": "rad, rad/s", "copy": "rad, rad/s", "push": "1"}
    return ComposedSystem("ignorant", plant, {"agent": [agent], "other": [other]}, units)


def audit(system: ComposedSystem, fault: str, folder: Path) -> faultpath.Run:
    options = {"baseline": "agent", "repair": "other", "scenes": 8, "folder": folder}
    return faultpath.audit(system, **options, fault=fault, signals=False, progress=False)


def test_a_fault_that_changes_no_reading_never_acted(system, tmp_path) -> None:
    run = audit(system, "pole:scale=1", tmp_path / "run")
    assert run.headline == "The fault never changed a reading: no effect of it was tested."
    assert run.headline in PAGE


def test_an_input_that_is_not_used_is_remarked(system) -> None:
    report = faultpath.check(system, workers=0, progress=False)
    remarks = [remark for check in report.checks for remark in check.remarks]
    (remark,) = [remark for remark in remarks if "agent.pole" in remark]
    sentence = "had no effect because the output of 'agent' never changed in any trial"
    assert sentence in remark
    assert sentence in PAGE
    assert not any("other.pole" in remark for remark in remarks)
