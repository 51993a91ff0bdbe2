"""`faultpath train`: what it prints, what it refuses, and how it stops."""

import sys
from pathlib import Path

import pytest
from cli_runs import ROOT, faultpath
from faultpath_quadrotor import models
from faultpath_quadrotor.training import catalogue, jobs

from faultpath.cli.main import INTERRUPTED
from faultpath.learning.model_card import read_card

sys.path.insert(0, str(ROOT / "tests" / "quadrotor"))
from fitting_toys import Toy, entry


@pytest.fixture(autouse=True)
def _toys(monkeypatch: pytest.MonkeyPatch) -> None:
    entries = (entry("one"), entry("one+dcc", seeds=(0, 1)), entry("bug"), entry("mistake"))
    monkeypatch.setattr(catalogue, "ALL", entries)
    monkeypatch.setattr(catalogue, "GROUPS", {"both": entries[:2], "all": entries[:2]})
    monkeypatch.setenv("COLUMNS", "200")


def _train(*arguments: object):
    return faultpath("train", "quadrotor", *arguments, "--workers", 0)


def test_everything_is_fitted_and_ends_in_a_table() -> None:
    ended = _train()
    assert ended.status == 0, ended.err
    assert "Fitting" in ended.err
    assert "Fitting" not in ended.out
    names = {path.name for path in Path("runs/train").glob("*.safetensors")}
    assert names == {"one-0.safetensors", "one+dcc-0.safetensors", "one+dcc-1.safetensors"}
    rows = [line.split() for line in ended.out.splitlines()]
    (head,) = (row for row in rows if row[:2] == ["model", "seed"])
    assert head[2:] == ["parameters", "loss", "validation", "time"]
    card = read_card(Path("runs/train/one+dcc-1.safetensors"), models.ModelCard)
    (row,) = (row for row in rows if row[:2] == ["one+dcc", "1"])
    assert row[2:4] == ["32", f"{card.training_loss[-1]:.4g}"]
    assert row[4:6] == ["error", f"{card.final['error']:.4g}"]
    assert "Checkpoints: runs/train" in ended.out


def test_names_seeds_and_folders_are_heeded(tmp_path: Path) -> None:
    ended = _train("one", "--seed", 3, "--seed", 1, "--out", tmp_path / "mine")
    assert ended.status == 0, ended.err
    stems = {path.stem for path in (tmp_path / "mine").glob("*.safetensors")}
    assert stems == {"one-1", "one-3"}
    assert not (tmp_path / "runs").exists()


def test_the_same_again_fits_nothing_and_what_is_finished_is_shipped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(models, "shipped_folder", lambda: tmp_path / "package")
    card = Path("runs/train/one-0.json")
    assert _train("one").status == 0
    before = card.read_bytes()
    assert _train("one", "--ship").status == 0
    assert card.read_bytes() == before
    assert models.checkpoint_path("one", 0).parent == tmp_path / "package"
    monkeypatch.setattr(Toy, "count", 149)
    assert "one-0 is fitted again: samples" in _train("one").err


def test_models_that_fail_are_told_and_change_the_status() -> None:
    ended = _train("bug", "mistake", "one")
    assert ended.status == 1
    assert "bug-0 was not fitted: ZeroDivisionError: the toy is broken" in ended.out
    assert "runs/train/bug-0.error.txt" in ended.out
    assert "mistake-0 was not fitted: the toy has no data: make some." in ended.out
    assert "Traceback" not in ended.out + ended.err
    assert Path("runs/train/one-0.safetensors").exists()


def flying(name: str, pool: str, *after: str) -> catalogue.ModelEntry:
    """Return a model that is fitted on a pool of flights, after other models."""
    factory = entry("one").factory
    return catalogue.ModelEntry(name, factory, (pool,), "", 9.0, seeds=(0,), after=after)


def test_missing_flights_are_collected_once_what_they_need_is_fitted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    calls: list[tuple[Path, tuple[str, ...], int]] = []

    def collect(folder: Path, pools, workers: int, progress) -> None:
        assert Path("runs/train/one-0.safetensors").exists() == (pools == ["flown"])
        progress(1.0, 2.0)
        calls.append((folder, pools, workers))

    monkeypatch.setattr(jobs, "collect", collect)
    monkeypatch.setattr(
        catalogue, "ALL", (flying("needy", "flown", "one"), flying("one", "nominal"))
    )
    ended = _train("needy", "one", "--data", "flights")
    assert ended.status == 0, ended.err
    assert calls == [(Path("flights"), [pool], 0) for pool in ("nominal", "flown")]
    assert "Collecting flown" in ended.err
    assert Path("runs/train/needy-0.safetensors").exists()


def test_closed_loop_flights_without_their_predictor_are_refused_before_any_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(models, "shipped_folder", lambda: tmp_path)
    monkeypatch.setattr(catalogue, "ALL", (flying("flown", "trajectory", "one"), entry("one")))
    _train("flown", "one").refused("no checkpoint of 'one' with seed 0")
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_says_what_is_kept_and_how_to_go_on(monkeypatch: pytest.MonkeyPatch) -> None:
    begin = Toy.begin_epoch

    def stop(self: Toy, epoch: int) -> None:
        begin(self, epoch)
        if (self.name, epoch) == ("one+dcc", 2):
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Toy, "begin_epoch", stop)
        ended = _train("both")
        assert ended.status == INTERRUPTED
        assert "interrupted with 1 of 3 models finished" in ended.err
        assert "kept in runs/train; run the same command again to resume" in ended.err
    assert _train("both").status == 0
    listed = faultpath("train", "quadrotor", "--list")
    assert listed.status == 0
    assert "one+dcc" in listed.out


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (["two"], ["'two'", "one, one+dcc, bug, mistake", "both, all"]),
        (["one", "--seed", "-1"], ["--seed", "0"]),
        (["one", "--out", "/proc/none"], ["/proc/none"]),
    ],
    ids=" ".join,
)
def test_a_mistake_is_one_sentence(arguments, names, tmp_path: Path) -> None:
    _train(*arguments).refused(*names)
    assert list(tmp_path.iterdir()) == []
