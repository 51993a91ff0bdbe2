"""A library that cannot be flown is refused, and the scene and the field are named."""

import re
from pathlib import Path
from typing import Any

import pytest
from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.scenes.library import (
    FROZEN,
    MOST_OBSTACLES,
    SceneLibrary,
    as_text,
    clearance_m,
    frozen_file,
    load_library,
    unsound,
)
from faultpath_quadrotor.scenes.scene import ArenaBounds, Box, Cylinder, Scene
from flights import spread

from faultpath.core.errors import UserError

BASE = load_library("selection").scenes


def renamed(scene: Scene, index: int, name: str = "mine") -> Scene:
    return scene.model_copy(update={"library": name, "index": index, "id": f"{name}/{index:03d}"})


def mine(**changed: object) -> SceneLibrary:
    """Return two sound scenes, the second with some fields changed."""
    scenes = (renamed(BASE[0], 0), renamed(BASE[1], 1).model_copy(update=changed))
    return SceneLibrary.of("mine", scenes)


def refused(path: Path, library: SceneLibrary) -> str:
    file = path / "mine.json"
    file.write_text(as_text(library), encoding="utf-8")
    with pytest.raises(UserError, match=r"\A.*mine\.json.*\Z") as told:
        load_library(file)
    return str(told.value)


@pytest.mark.parametrize("name", FROZEN)
def test_every_frozen_scene_is_sound_and_so_is_one_of_ones_own(name: str, tmp_path: Path) -> None:
    assert {unsound(scene) for scene in load_library(name).scenes} == {""}
    (tmp_path / "mine.json").write_text(as_text(mine()), encoding="utf-8")
    assert load_library(tmp_path / "mine.json") == mine()


def test_clearance_is_that_of_the_geometry() -> None:
    for scene in BASE[:20]:
        points = spread([scene], 50)
        exact = Geometry.stack([scene]).distance(points)[0]
        for point, distance in zip(points[:, 0].T.tolist(), exact.tolist(), strict=True):
            found = clearance_m(scene, tuple(point))
            assert (found > 0) == (distance > 0)
            assert distance < 0 or found == pytest.approx(distance, abs=1e-9)


TALL = Box(centre_m=(0.0, 0.0, 0.0), half_extents_m=(0.1, -0.1, 1.0))
FLAT = Cylinder(centre_m=(0.0, 0.0), radius_m=0.3, low_m=2.0, high_m=2.0)
PEBBLE = Box(centre_m=(0.0, 0.0, -5.0), half_extents_m=(0.01, 0.01, 0.01))
VEHICLE, LOW, HIGH = BASE[1].vehicle, BASE[1].bounds.low_m, BASE[1].bounds.high_m
PILLAR = Cylinder(centre_m=BASE[1].start_m[:2], radius_m=0.3, low_m=LOW[2], high_m=3)
CRATE = Box(centre_m=BASE[1].goal_m, half_extents_m=(0.3, 0.3, 0.3), yaw_rad=1.0)
THIN = VEHICLE.model_copy(update={"inertia_kgm2": (1.0, 0.1, 0.1)})
FAR = (5e4, 0.0, 1.0)
UNSOUND: dict[str, tuple[dict[str, Any], str]] = {
    "bounds": ({"bounds": ArenaBounds(low_m=HIGH, high_m=LOW)}, "field bounds"),
    "flat": ({"bounds": ArenaBounds(low_m=LOW, high_m=(*HIGH[:2], LOW[2]))}, "along z"),
    "huge": ({"bounds": ArenaBounds(low_m=(-900,) * 3, high_m=(900,) * 3)}, "cells of 0.1 m"),
    "far": ({"goal_m": FAR}, "field goal_m: lies beyond 1000 m"),
    "start outside": ({"start_m": (HIGH[0] + 1, 0.0, 1.0)}, "start_m: .*outside the bounds"),
    "goal below": ({"goal_m": (*BASE[1].goal_m[:2], LOW[2] - 1)}, "goal_m: .*outside the bounds"),
    "start at a wall": ({"start_m": (LOW[0] + 0.1, 0.0, 1.0)}, "start_m: .*needs 0.2 m"),
    "start in a pillar": ({"cylinders": (PILLAR,)}, "start_m: .*lies in an obstacle"),
    "goal in a box": ({"boxes": (CRATE,)}, "goal_m: .*lies in an obstacle"),
    "a negative side": ({"boxes": (*BASE[1].boxes, TALL)}, r"boxes\.\d+\.half_extents_m"),
    "no height": ({"cylinders": (FLAT,)}, r"cylinders\.0: low_m 2 is not below high_m 2"),
    "crowded": ({"boxes": (PEBBLE,) * (MOST_OBSTACLES + 1)}, "257 obstacles are too many"),
    "heavy": ({"vehicle": VEHICLE.model_copy(update={"mass_kg": 1e4})}, "cannot lift itself"),
    "there already": ({"goal_m": BASE[1].start_m}, "goal_m: within 0.5 m of start_m"),
    "no body": ({"vehicle": THIN}, "vehicle.inertia_kgm2"),
    "another's id": ({"id": "held-out/001"}, "field id: 'held-out/001' is not 'mine/001'"),
    "the same id": ({"id": "mine/000"}, "field id"),
    "another's library": ({"library": "other"}, "field library"),
    "another place": ({"index": 7}, "field index"),
}


@pytest.mark.parametrize(("changed", "says"), UNSOUND.values(), ids=UNSOUND)
def test_a_scene_that_cannot_be_flown_is_refused(tmp_path, changed, says):
    said = refused(tmp_path, mine(**changed))
    assert "scene 1" in said
    assert re.search(says, said), said


@pytest.mark.parametrize("name", ["", "../up", "-x", "a" * 65, "a\x1b[2J"])
def test_a_name_that_is_none_is_refused(tmp_path: Path, name: str) -> None:
    scenes = tuple(renamed(scene, index, name) for index, scene in enumerate(BASE[:2]))
    assert "its name" in refused(tmp_path, SceneLibrary.of(name, scenes))


def test_reserved_names_are_refused_unless_they_are_the_packages_own(tmp_path: Path) -> None:
    scenes = tuple(renamed(scene, index, "held-out") for index, scene in enumerate(BASE[:2]))
    assert "belongs to the package" in refused(tmp_path, SceneLibrary.of("held-out", scenes))
    copy = tmp_path / "copy.json"
    copy.write_text(frozen_file("selection").read_text("utf-8"), encoding="utf-8")
    assert load_library(copy) == load_library("selection")
