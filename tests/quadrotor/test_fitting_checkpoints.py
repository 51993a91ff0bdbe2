"""Checkpoints: what is read is what was fitted, or a sentence."""

import json
from hashlib import sha256
from pathlib import Path

import pytest
import torch
from faultpath_quadrotor import checkpoint
from faultpath_quadrotor.checkpoint import (
    ModelCard,
    checkpoint_path,
    load_checkpoint,
    ship,
    shipped_folder,
)
from faultpath_quadrotor.training.fitting import fit
from fitting_toys import Net, Toy

from faultpath.core.errors import UserError
from faultpath.learning.model_card import read_card


@pytest.fixture
def fitted(tmp_path: Path) -> Path:
    return fit(Toy(), tmp_path / "fitted")


def test_a_loaded_model_is_the_fitted_one(fitted: Path) -> None:
    task, module = Toy(), Net(seed=7)
    card = load_checkpoint(module, fitted)
    assert card == read_card(fitted, ModelCard)
    task.load()
    module.eval()
    assert task.validate(module) == card.final


def test_a_missing_checkpoint_is_named_with_the_command_that_makes_it() -> None:
    with pytest.raises(UserError, match=r"'wm-q' with seed 7 in ") as stop:
        checkpoint_path("wm-q", 7)
    assert "`faultpath train quadrotor wm-q --seed 7 --ship`" in str(stop.value)


def test_shipping_puts_a_checkpoint_where_the_package_finds_it(
    fitted: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(checkpoint, "shipped_folder", lambda: tmp_path / "package")
    ship(fitted)
    found = checkpoint_path("toy", 0)
    assert found.parent == tmp_path / "package"
    assert load_checkpoint(Net(3), found) == read_card(fitted, ModelCard)


def test_every_shipped_checkpoint_is_the_one_of_its_card() -> None:
    for path in sorted(shipped_folder().glob("*.safetensors")):
        card = read_card(path, ModelCard)
        assert card.stem == path.stem
        assert sha256(path.read_bytes()).hexdigest() == card.weights_sha256


class Wider(Net):
    def __init__(self) -> None:
        super().__init__(0)
        self.more = torch.nn.Parameter(torch.zeros(2))


def _cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-4])


def _exchange(path: Path) -> None:
    card = json.loads(path.with_suffix(".json").read_text())
    path.with_suffix(".json").write_text(json.dumps(card | {"weights_sha256": "00"}))


def _no_card(path: Path) -> None:
    path.with_suffix(".json").unlink()


def _other_card(path: Path) -> None:
    path.with_suffix(".json").write_text('{"format": "faultpath-model/9"}')


DAMAGES = {
    "cut": (_cut, "not those of its card"),
    "exchanged": (_exchange, "not those of its card"),
    "no card": (_no_card, "No such file"),
    "another card": (_other_card, "no card of a fit"),
    "no weights": (lambda path: path.unlink(), "No such file"),
}


@pytest.mark.parametrize(("damage", "says"), DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_checkpoint_is_refused(damage, says, fitted: Path) -> None:
    damage(fitted)
    with pytest.raises(UserError, match=says) as stop:
        load_checkpoint(Net(0), fitted)
    assert "toy-0" in str(stop.value)
    assert "fit the model again" in str(stop.value)


def test_another_architecture_is_refused(fitted: Path) -> None:
    with pytest.raises(UserError, match="another architecture"):
        load_checkpoint(Wider(), fitted)
