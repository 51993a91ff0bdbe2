"""The frozen libraries: what they contain, that they are feasible, intact and reproducible."""

import json
import math
import subprocess
import sys
from collections import Counter
from itertools import pairwise

import pytest
from faultpath_quadrotor.scenes.library import (
    FROZEN,
    Library,
    frozen_file,
    load_library,
)
from faultpath_quadrotor.scenes.prisms import floor_plan, prism
from faultpath_quadrotor.scenes.scene import Scene, Topology

from faultpath.core.errors import UserError

NAMES = list(FROZEN)


@pytest.fixture(scope="module")
def libraries() -> dict[str, Library]:
    return {name: load_library(name) for name in NAMES}


@pytest.mark.parametrize("name", NAMES)
def test_a_frozen_library_has_its_mix_in_any_twenty(libraries, name):
    library = libraries[name]
    assert [scene.id for scene in library] == [f"{name}/{i:03d}" for i in range(100)]
    assert all(scene.topology == list(Topology)[scene.index % 5] for scene in library)
    assert Counter(scene.occluded for scene in library) == {True: 25, False: 75}
    assert Counter(scene.topology for scene in library if scene.occluded) == dict.fromkeys(
        Topology, 5
    )
    assert 0.5 <= sum(scene.obstacles for scene in library) / len(library) <= 0.7
    for first in range(0, 100, 20):
        part = library.scenes[first : first + 20]
        assert Counter(scene.occluded for scene in part)[True] == 5
        assert {scene.obstacles for scene in part} == {True, False}


def test_libraries_share_no_geometry_and_no_vehicle(libraries):
    scenes = [scene for library in libraries.values() for scene in library]
    assert len({scene.id for scene in scenes}) == 300
    assert (
        len({(scene.boxes, scene.cylinders, scene.bounds, scene.start_m) for scene in scenes})
        == 300
    )
    assert len({scene.vehicle for scene in scenes}) == 300
    assert len({scene.content_hash for scene in scenes}) == 300
    assert len({library.content_hash for library in libraries.values()}) == 3


def test_asking_for_an_unknown_library_lists_what_there_is():
    with pytest.raises(UserError, match=r"'heldout'.*training, selection, held-out"):
        load_library("heldout")


def _damage_value(text: str) -> str:
    content = json.loads(text)
    content["scenes"][7]["goal_m"][0] += 0.01
    return json.dumps(content)


def _drop_scene(text: str) -> str:
    content = json.loads(text)
    del content["scenes"][50]
    return json.dumps(content)


def _other_format(text: str) -> str:
    return text.replace("faultpath-scenes/1", "faultpath-scenes/9")


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (_damage_value, "was changed"),
        (_drop_scene, "was changed"),
        (lambda text: text[: len(text) // 2], "cannot be read as a library"),
        (lambda text: "[1, 2]", "cannot be read as a library"),
        (
            lambda text: text.replace('"radius_m":0.', '"radius_m":-0.', 1),
            "cannot be read as a library",
        ),
        (_other_format, "format 'faultpath-scenes/9'"),
    ],
)
def test_a_damaged_file_is_refused_in_one_sentence(tmp_path, damage, reason):
    path = tmp_path / "scenes.json"
    path.write_text(damage(frozen_file("training").read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(UserError, match=reason) as caught:
        load_library(path)
    assert "scenes.json" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_hash_sees_every_field(libraries):
    scene = libraries["training"][0]
    changes: dict[str, object] = {
        "id": "x",
        "index": 1,
        "library": "x",
        "topology": Topology.ROOMS,
        "obstacles": not scene.obstacles,
        "occluded": not scene.occluded,
        "bounds": libraries["training"][1].bounds,
        "boxes": scene.boxes[1:],
        "cylinders": scene.cylinders[1:],
        "start_m": scene.goal_m,
        "goal_m": scene.start_m,
        "start_yaw_rad": 9.0,
        "vehicle": libraries["training"][1].vehicle,
    }
    assert set(changes) == set(Scene.model_fields)
    same = scene.content_hash
    hashes = {scene.model_copy(update={key: new}).content_hash for key, new in changes.items()}
    assert len(hashes - {same}) == len(changes)


def test_a_floor_plan_has_every_solid_and_the_free_variant_none(libraries):
    for scene in libraries["selection"].scenes[:10]:
        plan, empty = floor_plan(scene), floor_plan(scene, free_space=True)
        assert (len(plan.prisms), len(plan.pillars)) == (len(scene.boxes), len(scene.cylinders))
        assert (empty.prisms, empty.pillars) == ((), ())
        assert (empty.start, empty.goal, empty.low) == (plan.start, plan.goal, plan.low)
        assert all(low.bottom <= high.bottom for low, high in pairwise(plan.prisms))
        for box in scene.boxes:
            shape = next(p for p in plan.prisms if p.corners == prism(box).corners_m)
            sides = [math.dist(a, b) for a, b in pairwise(shape.corners)]
            hx, hy, hz = box.half_extents_m
            assert sides == pytest.approx([2 * hx, 2 * hy, 2 * hx])
            assert shape.top - shape.bottom == pytest.approx(2 * hz)


def test_drawing_does_not_load_torch():
    code = "import sys, faultpath_quadrotor.scenes.prisms; sys.exit('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
