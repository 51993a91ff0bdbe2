"""Checkpoints: what is read is what was fitted, or a sentence."""

from hashlib import sha256
from pathlib import Path

import pytest
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
