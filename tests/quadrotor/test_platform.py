"""The platform is one value to which weights belong; what a user chooses is what is built."""

import hashlib
import json
from pathlib import Path

import pytest
from faultpath_quadrotor import choices, models, options
from faultpath_quadrotor.choices import QuadrotorChoices
from faultpath_quadrotor.models import shipped_folder
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.planners import SamplerSettings
from faultpath_quadrotor.plant.wind import Winds
from faultpath_quadrotor.platform import PLATFORM, Platform

from faultpath.core.errors import UserError

CARDS = sorted(shipped_folder().glob("*.json"))
ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("path", CARDS, ids=lambda path: path.stem)
def test_every_shipped_weight_is_that_of_its_card_and_belongs_to_the_platform(path):
    card = json.loads(path.read_text())
    assert path.stem == f"{card['name']}-{card['seed']}"
    assert card["platform"] == PLATFORM.weights_hash(path.stem.rpartition("-")[0])
    weights = path.with_suffix(".safetensors").read_bytes()
    assert hashlib.sha256(weights).hexdigest() == card["weights_sha256"]


def test_weights_belong_to_what_decided_their_data():
    calm = Platform(winds=Winds(means_mps=(0.0, 1.0, 2.0, 3.0)))
    pooled = Platform(winds=Winds(pool_mean_mps=(0.0, 9.0)))
    assert len({each.hash for each in (PLATFORM, calm, pooled)}) == 3
    assert calm.weights_hash("wm-a") == PLATFORM.weights_hash("wm-a")
    assert calm.weights_hash("gru-trajectory") != PLATFORM.weights_hash("gru-trajectory")
    assert pooled.weights_hash("wm-a") != PLATFORM.weights_hash("wm-a")
    assert pooled.weights_hash("clearance") == PLATFORM.weights_hash("clearance")


def test_weights_of_another_platform_are_refused(monkeypatch):
    models.predictor.cache_clear()
    monkeypatch.setattr(models, "PLATFORM", Platform(drag_kgps=(0.3, 0.3, 0.3)))
    with pytest.raises(UserError, match=r"wm-a-0 .* another platform .* fit them again"):
        models.predictor("wm-a", 0)


def test_what_is_on_offer_is_what_there_is():
    for name in choices.PREDICTORS:
        assert "trim" in models.predictor(name, None).reads
    for name in choices.RECONSTRUCTIONS:
        assert models.reconstruction(name, None).reads
    for name in choices.ESTIMATORS:
        assert models.estimator(name).reads
    with pytest.raises(KeyError):  # a name without an estimator, which is not the plain filter
        models.estimator("wind")
    trusts = [models.estimator(f"eskf{rest}").trust for rest in ("", "-no-bias", "-cautious")]
    assert [(trust.biases, trust.doubt) for trust in trusts] == [(True, 1), (False, 1), (True, 3)]
    assert tuple(options.PLANNERS) == choices.PLANNERS
    for name, kind in options.PLANNERS.items():
        assert type(QuadrotorOptions(planner=name).build_planner()) is kind
    assert QuadrotorChoices().candidates == SamplerSettings().candidates
    assert f"`{PLATFORM.hash}`" in (ROOT / "docs" / "design" / "platform.md").read_text("utf-8")


def test_free_space_has_true_clearance_unless_it_is_chosen():
    parse = QuadrotorOptions.parse
    assert parse().clearance == "depth"
    assert parse(environment="free-space").clearance == "true"
    assert parse(environment="free-space", clearance="depth").clearance == "depth"
    assert parse(candidates="1024", wind="L2") == QuadrotorOptions(candidates=1024, wind="L2")
