"""What is measured of trained models, and that the page about it is what was measured."""

import json
import shutil
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import torch

from faultpath.errors import UserError
from faultpath.quadrotor.card import stem
from faultpath.quadrotor.checkpoint import save_checkpoint
from faultpath.quadrotor.models import PREDICTORS, Shelf
from faultpath.quadrotor.plant.wind import Winds
from faultpath.quadrotor.platforms import DEFAULT
from faultpath.quadrotor.predictors import KinematicIntegrator
from faultpath.quadrotor.presets import calibration
from faultpath.quadrotor.reconstruction import DisturbanceObserver, WindNetwork
from faultpath.quadrotor.training.collection import collect
from faultpath.quadrotor.training.playback import at_present
from faultpath.quadrotor.training.quality import Checkpoints, measure
from faultpath.quadrotor.training.quality_intervals import Episodes
from faultpath.quadrotor.training.quality_results import Quality
from faultpath.quadrotor.training.quality_rows import estimate, levels, position_errors
from faultpath.quadrotor.training.reconstruction_task import (
    CHECK_ERROR,
    MODELS,
    ReconstructionTask,
    _Samples,
)
from faultpath.quadrotor.training.windows import windows_of
from faultpath.quadrotor.vehicle import NOMINAL_DRAG_KGPS

ROOT = Path(__file__).resolve().parents[2]
EPISODES = {"nominal": 48, "wind": 10}
"""Few that have episodes on both sides of the split."""
PRESENT = [("wm-a", 0), ("wm-a", 1), ("wm-a-wind", 0), ("gru", 0), ("gru", 1), ("gru-withheld", 0)]


def blank(name, seed):
    """A network as it begins, but for a last layer that is not zero."""
    if learns_wind := name in MODELS:
        network = WindNetwork(MODELS[name].calibrated)
    else:
        network = PREDICTORS[name].load(name, None, Shelf()).network
    draw = torch.Generator().manual_seed(seed)
    network.initialise(draw)
    if not learns_wind:
        torch.nn.init.normal_(network.last.weight, std=0.05, generator=draw)
    return network


def save(folder, name, seed, data_sha256=None):
    card = {
        "name": name,
        "seed": seed,
        "description": "",
        "samples": 1,
        "schedule": {},
        "data_sha256": data_sha256 or {},
        "config": {},
        "order_key": name,
        "initial_sha256": "",
        "first_loss": 1.0,
        "training_loss": (),
        "validation": (),
        "duration_s": 0.0,
        "platform": DEFAULT.weights_hash(name),
        "torch_version": "",
        "faultpath_version": "",
    }
    save_checkpoint(blank(name, seed), folder / f"{stem(name, seed)}.safetensors", card)


@pytest.fixture(scope="module")
def data(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    collect(folder, workers=0, episodes=EPISODES)
    return folder


@pytest.fixture(scope="module")
def trained(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("trained")
    for name, seed in PRESENT:
        save(folder, name, seed)
    return folder


@pytest.fixture(scope="module")
def quality(data, trained) -> Quality:
    return measure(data, trained)


@pytest.fixture(scope="module")
def windy(data):
    return windows_of(data / "wind.parquet").split()[1]


@pytest.fixture
def tool(monkeypatch, tmp_path):
    """The generator of documents, with the page on learning alone, in another folder."""
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    for name in ("documents", "learning_blocks"):
        sys.modules.pop(name, None)
    import documents
    import learning_blocks

    monkeypatch.setattr(learning_blocks, "REFERENCE", tmp_path / "reference")
    monkeypatch.setattr(learning_blocks, "IMAGES", tmp_path / "images")
    monkeypatch.setattr(documents, "IMAGES", tmp_path / "images")
    monkeypatch.setattr(documents, "ROOT", tmp_path)
    monkeypatch.setattr(documents, "PAGES", (learning_blocks.pictures,))
    monkeypatch.setattr(documents, "documents", lambda: [tmp_path / "learning-quality.md"])
    return documents


@pytest.fixture
def docs(tmp_path, quality, tool) -> Path:
    """A copy of the page, filled from the tiny measurement."""
    (tmp_path / "reference").mkdir()
    (tmp_path / "images").mkdir()
    shutil.copy(ROOT / "docs" / "learning-quality.md", tmp_path)
    tool.learning_blocks.result_path().write_bytes(quality.encode())
    assert tool.main([]) == 0
    return tmp_path


def contents(folder):
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_every_interval_contains_its_estimate(quality):
    scores = [row.mean.median_m for row in quality.predictors]
    scores += [each.median_m for row in quality.predictors for each in row.seeds.values()]
    scores += [row.mean.rmse_mps for row in quality.reconstructions]
    assert all(each.low <= each.value <= each.high for each in scores)
    assert any(each.low < each.high for each in scores)


def test_the_bootstrap_resamples_episodes_and_not_windows():
    """Windows that repeat their episode's value tell nothing more of the spread of episodes."""
    values = np.random.default_rng(0).normal(size=40)
    once = Episodes("x", np.arange(40))
    often = Episodes("x", np.repeat(np.arange(40), 4))
    assert often.count == once.count == 40
    repeated = np.repeat(values, 4)
    assert often.median(repeated).interval() == once.median(values).interval()
    squares = often.root_mean_square(repeated**2), once.root_mean_square(values**2)
    np.testing.assert_allclose(squares[0].draws, squares[1].draws)


def test_resampled_medians_are_medians_of_the_resampled_windows():
    values = np.random.default_rng(1).normal(size=11)
    owner = np.array([0, 0, 0, 1, 1, 2, 2, 2, 2, 3, 3])
    episodes = Episodes("x", owner)
    weights = episodes._weights[:50].astype(int)
    expected = [np.median(np.repeat(values, row)) for row in weights]
    np.testing.assert_allclose(episodes.median(values).draws[:50], expected)


@pytest.mark.parametrize("name", ["dki", "true-parameter", "wm-a", "wm-u"])
def test_an_error_of_zero_is_no_error_to_the_bit(name, windy):
    made = PREDICTORS[name].load(name, None, Shelf())
    if name.startswith("wm"):
        made.network.load_state_dict(blank(name, 0).state_dict())
    with torch.inference_mode():
        plain = at_present(windy, made, None, {"wind": "true_wind"}).positions()[..., -1]
        expected = (plain - windy.position[:, -1]).norm(dim=0)
        assert torch.equal(position_errors(made, windy, 0.0)[-1], expected)
        assert not torch.equal(position_errors(made, windy, 0.1)[-1], expected)


def test_a_delivered_error_scales_mass_up_and_thrust_down_at_every_consumer(windy):
    made = PREDICTORS["wm-a"].load("wm-a", None, Shelf())
    with torch.inference_mode():
        present = at_present(windy, made, None, {}, [calibration(0.2)])
    struck = {tap for tap in present.told if tap[0] in windy.calibration}
    assert {consumer for _, consumer in struck} >= {"predictor.dynamics", "predictor.history"}
    for channel, consumer in struck:
        true, factor = (windy.mass_kg, 1.2) if channel == "mass" else (windy.thrust_scale, 0.8)
        torch.testing.assert_close(present[channel, consumer], factor * true)


def test_scores_without_an_error_are_those_of_the_horizon_and_of_the_table(quality):
    for row in quality.predictors:
        plain = next(each for each in row.mean.under_error if each.error == 0)
        assert plain.median_m == pytest.approx(row.mean.median_m.value)
        assert plain.median_m == pytest.approx(row.mean.horizon_m[-1])
        assert plain.p90_m == row.mean.p90_m >= plain.median_m
    for row in quality.reconstructions:
        plain = next(each for each in row.mean.under_error if each.error == 0)
        assert plain.rmse_mps == pytest.approx(row.mean.rmse_mps.value)
        assert plain.vertical_shift_mps == 0


def test_errors_grow_from_nothing_along_the_horizon(windy):
    made = KinematicIntegrator(drag_kgps=NOMINAL_DRAG_KGPS)
    errors = position_errors(made, windy)
    assert errors.shape == (20, len(windy))
    assert errors[0].max() < 0.02  # one interval of 50 ms
    assert errors[-1].median() > 10 * errors[0].median()


def test_the_mean_of_seeds_is_their_mean(quality):
    (row,) = [row for row in quality.predictors if row.name == "wm-a"]
    assert set(row.seeds) == {0, 1}
    values = [score.median_m.value for score in row.seeds.values()]
    assert values[0] != values[1]
    assert row.mean.median_m.value == pytest.approx(np.mean(values))


def test_wind_withheld_from_a_conditioned_predictor_changes_its_errors(quality):
    told = {row.wind: row.mean.horizon_m for row in quality.predictors if row.name == "wm-a-wind"}
    assert set(told) == {"true", "zero"}
    assert told["true"] != told["zero"]


def test_the_observer_has_no_seeds_and_calibration_moves_it_up(quality):
    (dob,) = [row for row in quality.reconstructions if row.name == "dob"]
    assert dob.seeds == {}
    shifts = [each.vertical_shift_mps for each in dob.mean.under_error]
    assert shifts == sorted(shifts)
    assert shifts[0] < -1
    assert shifts[-1] > 1


def test_what_learns_nothing_is_measured_alike_whatever_models_are_there(data, quality, tmp_path):
    alone = measure(data, tmp_path)
    assert [row.name for row in alone.reconstructions] == ["dob"]
    assert alone.reconstructions[0] == quality.reconstructions[0]
    analytic = [row for row in quality.predictors if not row.seeds]
    assert list(alone.predictors) == analytic
    assert len(alone.missing) == len(quality.missing) + len(PRESENT)


def test_a_reconstruction_without_calibration_cannot_shift(quality):
    (row,) = [row for row in quality.reconstructions if row.name == "gru-withheld"]
    assert {each.vertical_shift_mps for each in row.mean.under_error} == {0.0}
    assert len({each.rmse_mps for each in row.mean.under_error}) == 1


def test_a_network_is_measured_as_its_fit_validates_it(data, windy, quality):
    task = ReconstructionTask("gru", 0, data)
    task._scaled = network = blank("gru", 0)
    task._validation = _Samples.of(windy, network)
    with torch.no_grad():
        found = task.validate(network)
    (row,) = [row for row in quality.reconstructions if row.name == "gru"]
    score = row.seeds[0]
    assert score.rmse_mps.value == pytest.approx(found["wind_rmse_mps"], rel=1e-5)
    shift = next(each for each in score.under_error if each.error == CHECK_ERROR)
    assert shift.vertical_shift_mps == pytest.approx(found["calibration_shift_mps"], rel=1e-4)


def test_an_estimate_reads_nothing_after_the_present(windy):
    plain = estimate(DisturbanceObserver(drag_kgps=NOMINAL_DRAG_KGPS), windy)
    future = {
        name: torch.cat((value[..., :keep, :], torch.full_like(value[..., keep:, :], 1e3)), -2)
        for name, keep in (("velocity", 13), ("rotation", 13), ("rate", 13), ("command", 12))
        for value in (getattr(windy, name),)
    }
    assert torch.equal(
        estimate(DisturbanceObserver(drag_kgps=NOMINAL_DRAG_KGPS), replace(windy, **future)), plain
    )
    assert plain.isfinite().all()


def test_a_window_has_the_level_of_the_nearest_sustained_wind(windy):
    speed = windy.wind_mps.mean(1).norm(dim=0)
    winds = Winds()
    found = levels(windy, winds)
    for each, name in zip(speed.tolist(), found, strict=True):
        distance = {key: abs(each - level.mean_mps) for key, level in winds.levels.items()}
        assert distance[name] == min(distance.values())
    assert len(set(found)) > 1


def test_missing_checkpoints_are_named_and_leave_no_row(quality):
    assert "wm-u-0" in quality.missing
    assert "wm-a-2" in quality.missing
    assert "clearance-0" in quality.missing
    assert "wm-a-0" not in quality.missing
    assert [(each.name, each.seed) for each in quality.checkpoints] == PRESENT
    assert "wm-u" not in {row.name for row in quality.predictors}
    assert quality.clearance is None


def test_weights_without_a_card_are_not_finished(trained, tmp_path):
    shutil.copy(trained / "gru-0.safetensors", tmp_path)
    assert "gru-0" in Checkpoints(Shelf(DEFAULT, tmp_path)).missing


def test_a_model_of_another_pool_is_refused(data, tmp_path):
    save(tmp_path, "gru", 0, {"wind": "other"})
    with pytest.raises(UserError, match="gru-0 was fitted to another pool 'wind'"):
        measure(data, tmp_path)


def test_a_measurement_survives_its_file(quality):
    text = quality.encode()
    assert Quality.model_validate_json(text).encode() == text


def test_writing_again_changes_nothing_and_the_page_passes_its_check(docs, tool, capsys):
    before = contents(docs)
    assert (
        len([path for path in before if path.suffix == ".svg"])
        == len(tool.learning_blocks.PICTURES) - 1
    )
    assert tool.main([]) == 0
    assert contents(docs) == before
    assert tool.main(["--check"]) == 0
    assert "Up to date" in capsys.readouterr().out


def test_the_page_has_every_table_and_picture_and_names_what_is_missing(docs, tool):
    page = (docs / "learning-quality.md").read_text()
    names = {match["name"] for match in tool.BLOCK.finditer(page)}
    known = tool.learning_blocks
    assert names == {f"learning:{block}" for block in known.BLOCKS} | {"training-time"}
    assert "`wm-u+dcc-2`" in page
    assert tool.learning_blocks.ABSENT in page  # the clearance model


@pytest.mark.parametrize("where", ["learning-quality.md", "images/learning-horizon.svg"])
def test_an_edited_number_fails_the_check(where, docs, tool, capsys):
    path = docs / where
    path.write_text(path.read_text().replace("0.", "1.", 1))
    assert tool.main(["--check"]) == 1
    assert Path(where).name in capsys.readouterr().out


def test_a_picture_of_nothing_measured_is_stale_and_goes(docs, tool, capsys):
    left = docs / "images" / "learning-clearance.svg"
    left.write_text("old")
    assert tool.main(["--check"]) == 1
    assert tool.main([]) == 0
    assert not left.exists()


@pytest.mark.parametrize(
    ("marker", "said"),
    [
        ("<!-- begin:learning:origin -->", "stands alone"),
        ("<!-- begin:learning:x -->\n<!-- end:learning:x -->", "no block 'x'"),
    ],
)
def test_a_wrong_block_is_refused(marker, said, docs, tool, capsys):
    page = docs / "learning-quality.md"
    page.write_text(f"{page.read_text()}\n{marker}\n")
    assert tool.main([]) == 2
    assert said in capsys.readouterr().err


def test_without_a_measurement_nothing_is_written(docs, tool, capsys):
    tool.learning_blocks.result_path().unlink()
    before = contents(docs)
    assert tool.main([]) == 2
    assert "run tools/learning_quality.py" in capsys.readouterr().err
    assert contents(docs) == before


def test_clearance_is_shown_where_it_was_measured(docs, tool, quality):
    errors = {"count": 3, "absolute_m": [0, 0.1, 0.2, 0.3, 0.9], "signed_m": [0, 0, 0.05, 0, 0]}
    none = {"count": 0, "absolute_m": None, "signed_m": None, "wrong_sign": None}
    found = {
        "library": "selection",
        "seed": 0,
        "images": 2,
        "quantiles": [0.05, 0.25, 0.5, 0.75, 0.95],
        "overall": errors | {"wrong_sign": 0.25},
        "calibration": [
            {"low_m": 0.1 * i, "high_m": 0.1 * i + 0.1, "estimate_m": [0.1 * i] * 5}
            for i in range(3)
        ],
        "by_range": [{"low_m": 0.0, "high_m": 1.0} | none],
        "by_visibility": {"in view": errors | {"wrong_sign": 0.25}},
    }
    measured = json.loads(quality.encode()) | {"clearance": found}
    tool.learning_blocks.result_path().write_text(json.dumps(measured))
    assert tool.main([]) == 0
    page = (docs / "learning-quality.md").read_text()
    assert "| in view | 3 | 0.200 | 0.900 | +0.050 | 25 |" in page
    assert "| 0 to 1 m away | 0 | – | – | – | – |" in page
    assert "no points" in (docs / "images" / "learning-clearance.svg").read_text()


def test_labels_of_close_curves_are_apart_and_keep_their_order(tool):
    from learning_curves import PITCH, spread

    places = spread([10.0, 11.0, 12.0, 60.0, 61.0, 200.0])
    assert all(below - above >= PITCH - 1e-9 for above, below in pairwise(places))
    assert places[-1] == 200.0
    assert sum(places[:3]) == pytest.approx(33.0)
