"""One model: what its weights depend on, what survives a stop, and what is read of it."""

import itertools
from pathlib import Path

import pytest
import torch
from faultpath_quadrotor import models
from faultpath_quadrotor.models import ModelCard, checkpoint_path
from faultpath_quadrotor.training import jobs
from faultpath_quadrotor.training.fitting import fit, journal_path
from fitting_toys import Net, Toy
from safetensors.torch import load_file

from faultpath.core.errors import UserError
from faultpath.core.files.atomic import write
from faultpath.learning.loop import Diverged
from faultpath.learning.model_card import Schedule, fill
from faultpath.learning.model_card import read_card as read


def read_card(path: Path) -> ModelCard:
    return read(path, ModelCard)


def _silent(text: str) -> None:
    raise AssertionError(f"nothing was to be said, but: {text}")


def _fit(task: Toy, folder: Path) -> bytes:
    return fit(task, folder, notice=_silent).read_bytes()


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return _fit(Toy(), tmp_path_factory.mktemp("reference"))


def test_fitting_helps_and_its_card_says_so(tmp_path: Path) -> None:
    path = fit(Toy(epochs=20, learning_rate=0.02), tmp_path, notice=_silent)
    card = read_card(path)
    assert len(card.training_loss) == len(card.validation) == 20
    assert card.training_loss[-1] < 0.2 * card.training_loss[0]
    assert card.final["error"] < 0.5 * card.validation[0]["error"]
    assert (card.parameters, card.samples, card.schedule.epochs) == (32, 150, 20)
    assert (card.data_sha256, card.config) == ({"toy": "3fa9"}, {"magnitude": 0.0})
    assert sorted(item.name for item in tmp_path.iterdir()) == ["toy-0.json", "toy-0.safetensors"]
    assert _fit(Toy(seed=1, epochs=1), tmp_path) != _fit(Toy(epochs=1), tmp_path / "other")


@pytest.mark.parametrize(
    ("optimiser", "stop"), [("adam", (0, 3)), ("adam", (2, 4)), ("adamw", (3, 2))]
)
def test_an_interrupted_fit_goes_on_to_the_same_bits(optimiser, stop, tmp_path):
    whole = _fit(Toy(optimiser=optimiser), tmp_path / "whole")
    cut = Toy(optimiser=optimiser)
    cut.stop_at = stop
    with pytest.raises(KeyboardInterrupt):
        _fit(cut, tmp_path / "cut")
    path = tmp_path / "cut" / "toy-0.safetensors"
    assert not path.exists()
    assert journal_path(path).exists() == (stop[0] > 0)
    assert _fit(Toy(optimiser=optimiser), tmp_path / "cut") == whole
    first, second = (read_card(tmp_path / f / path.name) for f in ("whole", "cut"))
    assert first.training_loss == second.training_loss
    assert first.validation == second.validation


def test_a_stop_at_any_write_loses_no_bits(reference, tmp_path, monkeypatch):
    """The journal of each epoch, the weights and the card: each write in turn is the last."""
    for survived in itertools.count():
        folder = tmp_path / str(survived)
        writes = itertools.count()

        def stopping(path, data, inside, original=write, limit=survived, writes=writes):
            if next(writes) == limit:
                raise KeyboardInterrupt
            original(path, data)

        with monkeypatch.context() as patch:
            patch.setattr("faultpath.core.files.atomic.write", stopping)
            try:
                _fit(Toy(), folder)
            except KeyboardInterrupt:
                pass
            else:
                break
        assert fit(Toy(), folder, notice=lambda _: None).read_bytes() == reference
        assert not journal_path(folder / "toy-0.safetensors").exists()
    assert survived == 6  # four epochs, weights, card


def test_a_finished_model_is_left_alone_and_a_damaged_one_fitted_again(reference, tmp_path):
    path = fit(Toy(), tmp_path, notice=_silent)
    assert path.read_bytes() == reference
    card = path.with_suffix(".json")
    before, task = (path.stat().st_mtime_ns, card.read_bytes()), Toy()
    task.stop_at = (0, 0)
    assert fit(task, tmp_path, notice=_silent) == path
    assert (path.stat().st_mtime_ns, card.read_bytes()) == before
    for broken, content in ((path, path.read_bytes()[:-1] + b" "), (card, b"{")):
        broken.write_bytes(content)
        messages: list[str] = []
        assert fit(Toy(), tmp_path, notice=messages.append).read_bytes() == reference
        assert [text.startswith("toy-0 is fitted again") for text in messages] == [True]


CHANGES = {
    "schedule": lambda task: setattr(task, "schedule", Schedule(epochs=2)),
    "data_sha256": lambda task: setattr(task, "data_sha256", "ffff"),
    "config": lambda task: setattr(task, "magnitude", 0.1),
    "initial_sha256": lambda task: setattr(task, "module", lambda: Net(5)),
    "first_loss": lambda task: setattr(task, "weight", 1.01),
}


@pytest.mark.parametrize(("word", "change"), CHANGES.items(), ids=CHANGES)
def test_a_changed_task_is_fitted_again_and_says_why(word, change, tmp_path: Path) -> None:
    fit(Toy(), tmp_path, notice=_silent)
    task = Toy()
    change(task)
    said: list[str] = []
    path = fit(task, tmp_path, notice=said.append)
    assert [text.startswith("toy-0 is fitted again: ") for text in said] == [True]
    assert word in said[0]
    assert fit(task, tmp_path, notice=_silent) == path


def test_a_loss_that_is_no_number_stops_with_the_last_good_state(tmp_path: Path) -> None:
    task = Toy()
    task.poisoned = 2
    with pytest.raises(Diverged, match=r"loss of toy-0 .* epoch 3 of 4: lower .* epoch 2 is kept"):
        _fit(task, tmp_path)
    path = tmp_path / "toy-0.safetensors"
    assert not path.exists()
    kept = load_file(journal_path(path))
    assert all(value.isfinite().all() for value in kept.values())
    shorter = fit(Toy(epochs=2), tmp_path / "shorter", notice=_silent)
    for name, value in load_file(shorter).items():
        assert torch.equal(kept[f"model.{name}"], value)


def test_a_shipped_model_is_found_and_is_the_fitted_one(tmp_path, monkeypatch):
    fitted = fit(Toy(), tmp_path, notice=_silent)
    monkeypatch.setattr(models, "shipped_folder", lambda: tmp_path / "package")
    jobs.ship(fitted)
    task, module = Toy(), Net(seed=7)
    card = fill(module, checkpoint_path("toy", 0), ModelCard)
    assert card == read_card(fitted)
    task.load()
    module.eval()
    assert task.validate(module) == card.final
    with pytest.raises(UserError, match="`faultpath train quadrotor wm-q --seed 7 --ship`"):
        checkpoint_path("wm-q", 7)
