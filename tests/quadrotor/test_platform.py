"""A platform is one value: frozen by name, told apart by hash, and handed to all that needs it."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from flights import HELD_OUT, STEPS, fault, fly

from faultpath.errors import UserError
from faultpath.quadrotor import models
from faultpath.quadrotor.checkpoint import checkpoint_path, shipped_folder
from faultpath.quadrotor.options import QuadrotorOptions
from faultpath.quadrotor.perception import PerceptionSettings
from faultpath.quadrotor.planners import BlendedGoal, CostWeights, NavigationCost
from faultpath.quadrotor.plant.wind import Winds
from faultpath.quadrotor.platform import PlannerSettings, Platform, SceneVehicles
from faultpath.quadrotor.platform_name import PlatformName
from faultpath.quadrotor.platforms import FIRST, PLATFORMS, name_of
from faultpath.quadrotor.scenes.library import load_library
from faultpath.quadrotor.system import Quadrotor
from faultpath.quadrotor.training.collection import different, recipe
from faultpath.quadrotor.training.predictor_task import PredictorTask
from faultpath.quadrotor.vehicle import VehicleParameters, VehicleRanges

FROZEN = Path(__file__).parents[2] / "docs/design/platform-search"
DAMPED = FIRST.with_drag((0.5, 0.5, 1.2))


def flown_on(platform: Platform, **options: str) -> Quadrotor:
    """Return a quadrotor on a platform that is not frozen, with the shipped weights."""
    own = {"settings": platform, "checkpoints": shipped_folder()}
    return Quadrotor(QuadrotorOptions.model_validate({**options, **own}))


def test_every_name_has_a_platform_that_is_frozen():
    assert set(PLATFORMS) == set(PlatformName)
    for name, platform in PLATFORMS.items():
        record = json.loads((FROZEN / f"platform-{name}.json").read_text())
        assert record == {"hash": platform.hash, "platform": platform.described()}
        assert name_of(platform) == name
        assert Platform.model_validate_json(platform.model_dump_json()) == platform


def test_the_first_platform_is_what_the_first_searches_froze():
    then = json.loads((FROZEN / "frozen.json").read_text())["platform"]
    now = FIRST.described()
    planner = now["planner"]
    assert then["planner"]["terminal"] == planner["weights"]
    assert then["planner"]["running"] == planner["running"]
    assert then["planner"]["sampler"] == planner["sampler"]
    assert then["planner"]["temperature"] == planner["temperature"]
    assert [level["mean_mps"] for level in then["wind"].values()] == now["winds"]["means_mps"]
    assert then["vehicle"]["drag_kgps"] == now["drag_kgps"]
    assert set(now["camera"].items()) <= set(then["perception"].items())
    for name in ("unseen_m", "near_m"):
        assert then["perception"][name] == now["perception"][name]


def test_the_chosen_record_flew_the_frozen_planner():
    """The last stage of the search flew, among others, exactly what is frozen."""
    planner = FIRST.planner
    flown = [
        result
        for result in json.loads((FROZEN / "6-learned-chosen.json").read_text())
        if result["planner"] == "terminal"
    ]
    assert flown
    for result in flown:
        point = result["point"]
        assert planner.temperature == point["temperature"]
        assert planner.sampler.rate_sigma_radps[0] == point["rate_sigma"]
        for weight in ("rate_effort", "margin_m", "thrust_effort"):
            assert getattr(planner.weights, weight) == point[weight]


def test_drag_moves_its_ranges_in_proportion():
    lows, highs = zip(*DAMPED.ranges.drag_kgps, strict=True)
    assert DAMPED.drag_kgps == (0.5, 0.5, 1.2)
    assert np.allclose(lows, np.array(DAMPED.drag_kgps) / 3)
    assert np.allclose(highs, np.array(DAMPED.drag_kgps) * 5 / 3)
    assert FIRST.ranges == VehicleRanges()


def test_scenes_fly_their_own_vehicle_or_the_nominal_one():
    scenes = load_library("selection").scenes[:20]
    assert all(FIRST.scene(scene) is scene for scene in scenes)
    for scene in scenes:
        drawn, flown = scene.vehicle, DAMPED.scene(scene).vehicle
        assert np.allclose(
            flown.drag_kgps, np.array(drawn.drag_kgps) * np.array(DAMPED.drag_kgps) / 0.3
        )
        assert flown.model_copy(update={"drag_kgps": drawn.drag_kgps}) == drawn
    nothing = SceneVehicles(drag_drawn=False, calibration_drawn=False, rest_drawn=False)
    still = DAMPED.model_copy(update={"scene_vehicles": nothing})
    nominal = VehicleParameters(drag_kgps=DAMPED.drag_kgps)
    assert {still.scene(scene).vehicle for scene in scenes} == {nominal}
    masses = DAMPED.model_copy(update={"scene_vehicles": SceneVehicles(drag_drawn=False)})
    vehicles = [masses.scene(scene).vehicle for scene in scenes]
    assert {vehicle.drag_kgps for vehicle in vehicles} == {DAMPED.drag_kgps}
    assert [v.mass_kg for v in vehicles] == [scene.vehicle.mass_kg for scene in scenes]


def test_other_winds_keep_their_shares_and_directions():
    weak = Winds(means_mps=(0.0, 1.0, 2.125, 3.85))
    strong = Winds()
    for name in ("L1", "L2", "L3"):
        halved, whole = weak.levels[name], strong.levels[name]
        assert halved.turbulence_mps == pytest.approx(whole.turbulence_mps / 2)
        flow, other = (w.series(name, "s", 12.0, 20).mean(0) for w in (weak, strong))
        cosine = flow @ other / np.linalg.norm(flow) / np.linalg.norm(other)
        assert cosine > 0.98


def test_weights_belong_to_what_decided_their_data():
    planned = FIRST.model_copy(update={"planner": PlannerSettings(goal_running=0.35)})
    calm = FIRST.model_copy(update={"winds": Winds(means_mps=(0.0, 1.0, 2.0, 3.0))})
    pooled = FIRST.model_copy(update={"winds": Winds(pool_mean_mps=(0.0, 6.0))})
    assert len({each.hash for each in (FIRST, planned, calm, pooled, DAMPED)}) == 5
    for shared in (planned, calm):
        assert shared.weights_hash("wm-a") == FIRST.weights_hash("wm-a")
        assert shared.weights_hash("gru-trajectory") != FIRST.weights_hash("gru-trajectory")
    for apart in (pooled, DAMPED):
        assert apart.weights_hash("wm-a") != FIRST.weights_hash("wm-a")
        assert apart.weights_hash("clearance") == FIRST.weights_hash("clearance")


def test_weights_of_another_platform_are_refused():
    here = models.Shelf(DAMPED, shipped_folder(PlatformName.FIRST))
    assert models.clearance_model(shelf=here) is not None
    for name in ("wm-a", "wm-u", "wm-a-wind"):
        with pytest.raises(UserError, match=f"{name}-0 .* another platform .* fit them again"):
            models.predictor(name, 0, shelf=here)
    with pytest.raises(UserError, match=r"gru-0 .* another platform"):
        models.reconstruction("gru", 0, shelf=here)
    with pytest.raises(UserError, match="not one of the package's: name the folder"):
        models.predictor("wm-a", 0, shelf=models.Shelf(DAMPED))


def test_tasks_and_pools_belong_to_their_platform(tmp_path):
    def key(platform: Platform) -> str:
        return PredictorTask("wm-a", 0, tmp_path, platform=platform).platform

    assert key(FIRST) == FIRST.weights_hash("wm-a") != key(DAMPED)
    harder = FIRST.model_copy(
        update={
            "collection": FIRST.collection.model_copy(
                update={
                    "perturbation": FIRST.collection.perturbation.model_copy(
                        update={"thrust_sigma": 0.08}
                    )
                }
            )
        }
    )
    asked = recipe("wind", platform=FIRST)
    assert different(recipe("wind", platform=harder), asked) == ["flight"]
    assert different(recipe("wind", platform=DAMPED), asked) == ["vehicle"]
    pooled = FIRST.model_copy(update={"winds": Winds(pool_mean_mps=(0.0, 6.0))})
    assert different(recipe("wind", platform=pooled), asked) == ["wind"]
    assert different(recipe("nominal", platform=pooled), recipe("nominal", platform=FIRST)) == []


def test_predictors_and_observers_assume_the_nominal_drag():
    shelf = models.Shelf(DAMPED, shipped_folder())
    for name in ("dki", "dki-drag"):
        air = models.predictor(name, None, shelf=shelf).air
        assert air.coefficients_kgps == DAMPED.drag_kgps
    assert models.predictor("wm-a-wind", None, shelf=shelf).kinematics.air.coefficients_kgps == (
        DAMPED.drag_kgps
    )
    level, still = torch.eye(3)[..., None], torch.ones(3, 1)
    force = models.reconstruction("dob", None, shelf=shelf)._air.force(level, still)
    assert force[:, 0].tolist() == pytest.approx(DAMPED.drag_kgps)


def test_the_planner_of_a_platform_is_its_own_and_both_ends_keep_their_names():
    stiff = PlannerSettings(goal_running=0.35, weights=CostWeights(thrust_effort=5.0))
    platform = FIRST.model_copy(update={"planner": stiff})

    def cost(name: str) -> NavigationCost:
        planner = flown_on(platform, planner=name).options.build_planner()
        found = planner._cost
        assert isinstance(found, NavigationCost)
        return found

    assert isinstance(cost("mppi").goal, BlendedGoal)
    assert {name: cost(name).goal.running for name in ("terminal", "mppi", "running", "cem")} == {
        "terminal": 0.0,
        "mppi": 0.35,
        "running": 1.0,
        "cem": 0.35,
    }


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("faultpath.quadrotor.plant.module.CONTROL_STEPS", STEPS)


@pytest.mark.usefixtures("short")
def test_outcomes_and_fingerprints_tell_platforms_apart():
    first, damped = (
        flown_on(platform, predictor="dki", clearance="true", wind="L2")
        for platform in (FIRST, DAMPED)
    )
    assert first.fingerprint() != damped.fingerprint()
    here, there = (fly(system, "dki", HELD_OUT[:2])[0] for system in (first, damped))
    for one, other in zip(here, there, strict=True):
        assert one.initial_hash != other.initial_hash, "another vehicle starts"
        assert one.metrics["terminal_distance_m"] != other.metrics["terminal_distance_m"]
    calm = FIRST.model_copy(update={"winds": Winds(means_mps=(0.0, 1.0, 2.0, 3.0))})
    gentle = flown_on(calm, predictor="dki", clearance="true", wind="L2")
    (still,), _ = fly(gentle, "dki", HELD_OUT[:1])
    assert still.initial_hash == here[0].initial_hash
    assert still.disturbance_hash != here[0].disturbance_hash


@pytest.mark.usefixtures("short")
def test_known_altitudes_pass_a_tap_of_their_own():
    known = FIRST.model_copy(update={"perception": PerceptionSettings(altitude_limits=True)})
    blind, seeing = (flown_on(each, predictor="dki") for each in (FIRST, known))
    assert "altitude_limits" not in {channel.name for channel in blind.interface.channels}
    assert seeing.interface.source("geofence").provenance == "commanded"
    assert "perception.limits" in seeing.variants["dki"].consumers
    raised = fault("altitude_limits:offset=1.5/1.5", seeing)
    exact, _ = fly(seeing, "dki", HELD_OUT[:2])
    lifted, _ = fly(seeing, "dki", HELD_OUT[:2], [raised])
    for one, other in zip(exact, lifted, strict=True):
        assert one.metrics["terminal_distance_m"] != other.metrics["terminal_distance_m"]


def test_a_model_that_a_platform_lacks_is_named_with_the_command_that_fits_it(tmp_path):
    with pytest.raises(UserError, match=r"wm-a.*'other'.*--platform other --ship` makes it"):
        checkpoint_path("wm-a", 7, shipped_folder().parent / "other")
    with pytest.raises(UserError, match=rf"in {tmp_path}.*--out {tmp_path}` makes it"):
        checkpoint_path("wm-a", 7, tmp_path)
