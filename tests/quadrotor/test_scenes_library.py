"""The frozen libraries: what they contain, that they are feasible, intact and reproducible."""

import json
import math
import subprocess
import sys
from collections import Counter
from itertools import combinations, pairwise

import pytest

from faultpath.errors import UserError
from faultpath.quadrotor.scenes.draw import floor_plan
from faultpath.quadrotor.scenes.feasibility import END_CLEARANCE_M, FreeLattice
from faultpath.quadrotor.scenes.generate import (
    SEEN_AHEAD_OCCLUDED_M,
    SEEN_AHEAD_OPEN_M,
    generate_scene,
)
from faultpath.quadrotor.scenes.layout import MIN_GAP_M, Door, Layout
from faultpath.quadrotor.scenes.library import (
    FROZEN_SEEDS,
    Library,
    as_text,
    frozen_file,
    load_library,
    write_library,
)
from faultpath.quadrotor.scenes.prisms import plan_gap, prism
from faultpath.quadrotor.scenes.scene import Box, Cylinder, Scene, Topology
from faultpath.quadrotor.scenes.soundness import clearance_m
from faultpath.streams import generator

NAMES = list(FROZEN_SEEDS)


@pytest.fixture(scope="module")
def libraries() -> dict[str, Library]:
    return {name: load_library(name) for name in NAMES}


def hall() -> Layout:
    return Layout(generator("test", "hall", 0), (9.0, 6.0, 3.0))


@pytest.mark.parametrize("name", NAMES)
def test_every_frozen_scene_is_feasible(libraries, name):
    """A sphere of the collision radius and a margin gets from start to goal."""
    for scene in libraries[name]:
        assert FreeLattice.of(scene).path_length_m() < math.inf, scene.id
        for end in (scene.start_m, scene.goal_m):
            assert clearance_m(scene, end) >= END_CLEARANCE_M, scene.id
        assert 6.0 <= math.dist(scene.start_m, scene.goal_m) <= 8.0, scene.id


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
    assert len(set(FROZEN_SEEDS.values())) == 3


@pytest.mark.parametrize("name", NAMES)
def test_frozen_files_come_from_their_seeds_to_the_byte(libraries, name):
    lines = frozen_file(name).read_text(encoding="utf-8").splitlines()[1:-1]
    assert len(lines) == 100
    for index in (0, 1, 2, 3, 4, 52):
        scene = generate_scene(name, index, FROZEN_SEEDS[name])
        assert scene == libraries[name][index]
        line = as_text(Library.of(name, (scene,))).splitlines()[1]
        assert line == lines[index].rstrip(",")
    assert as_text(libraries[name]) == frozen_file(name).read_text(encoding="utf-8")


def test_occlusion_is_what_a_short_look_ahead_does_not_get_past(libraries):
    for scene in libraries["selection"].scenes[21:26]:
        lattice = FreeLattice.of(scene)
        if scene.occluded:
            assert not lattice.found_by_looking(SEEN_AHEAD_OCCLUDED_M)
            assert lattice.found_by_looking(12.0)
            assert lattice.path_length_m() > 1.05 * math.dist(scene.start_m, scene.goal_m)
        else:
            assert lattice.found_by_looking(SEEN_AHEAD_OPEN_M)


def test_a_wall_without_a_door_is_found_infeasible(libraries):
    scene = libraries["training"][3]
    shut = hall()
    shut.wall("y", 0.0)
    closed = scene.model_copy(update={"boxes": tuple(shut.solids), "cylinders": ()})
    lattice = FreeLattice.of(closed)
    assert lattice.path_length_m() == math.inf


@pytest.mark.parametrize(("width", "passes"), [(0.55, False), (0.75, True)])
def test_a_door_must_let_the_sphere_and_its_margin_through(libraries, width, passes):
    scene = libraries["training"][3]
    layout = hall()
    layout.wall("y", 0.0, doors=[Door(0.0, width)])
    bounds = layout.bounds
    narrow = scene.model_copy(
        update={"boxes": tuple(layout.solids), "cylinders": (), "bounds": bounds}
    )
    assert (FreeLattice.of(narrow).path_length_m() < math.inf) == passes


def test_loose_obstacles_keep_their_gaps(libraries):
    """In open clutter everything is loose; written to the millimetre, gaps may lose two."""
    checked = 0
    for library in libraries.values():
        for scene in library:
            if scene.topology is not Topology.CLUTTER or scene.occluded:
                continue
            for one, other in combinations(map(prism, (*scene.boxes, *scene.cylinders)), 2):
                assert plan_gap(one, other) >= MIN_GAP_M - 0.002, scene.id
                checked += 1
    assert checked > 1000


def test_gaps_between_known_shapes():
    box, turned, pillar, other = map(
        prism,
        (
            Box(centre_m=(0.0, 0.0, 1.0), half_extents_m=(1.0, 0.5, 1.0)),
            Box(centre_m=(3.0, 0.0, 1.0), half_extents_m=(0.5, 0.5, 1.0), yaw_rad=math.pi / 4),
            Cylinder(centre_m=(0.0, 2.0), radius_m=0.3, low_m=0.0, high_m=2.0),
            Cylinder(centre_m=(3.0, 6.0), radius_m=0.7, low_m=0.0, high_m=2.0),
        ),
    )
    assert plan_gap(box, turned) == pytest.approx(2.0 - math.sqrt(0.5))
    assert plan_gap(turned, box) == plan_gap(box, turned)
    assert plan_gap(box, pillar) == plan_gap(pillar, box) == pytest.approx(1.2)
    assert plan_gap(pillar, other) == pytest.approx(4.0)


@pytest.mark.parametrize("width", [1.5, 2.2])
def test_corridor_walls_stand_the_width_apart(width):
    layout = hall()
    layout.corridor([(-4.5, 0.0), (0.0, 0.0), (0.0, 0.8), (4.5, 0.8)], width)
    middle = Cylinder(centre_m=(-3.0, 0.0), radius_m=0.001, low_m=0.0, high_m=3.0)
    after = Cylinder(centre_m=(3.0, 0.8), radius_m=0.001, low_m=0.0, high_m=3.0)
    for probe in (middle, after):
        nearest = sorted(plan_gap(prism(probe), prism(box)) for box in layout.solids)
        assert nearest[:2] == pytest.approx([width / 2] * 2, abs=0.011)


def test_a_library_of_ones_own_is_written_and_read_back(tmp_path):
    written = write_library(tmp_path / "mine" / "scenes.json", seed=5, count=3, name="mine")
    read = load_library(tmp_path / "mine" / "scenes.json")
    assert read == written
    assert load_library(str(tmp_path / "mine" / "scenes.json")) == written
    assert [scene.id for scene in read] == [f"mine/{i:03d}" for i in range(3)]
    other = write_library(tmp_path / "other.json", seed=6, count=1, name="mine")
    assert other[0] != written[0]


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


def test_writing_refuses_taken_names_existing_files_and_empty_libraries(tmp_path):
    taken = tmp_path / "taken.json"
    taken.write_text("mine", encoding="utf-8")
    with pytest.raises(UserError, match="belongs to the package"):
        write_library(tmp_path / "a.json", seed=1, count=1, name="held-out")
    with pytest.raises(UserError, match="exists already"):
        write_library(taken, seed=1, count=1, name="mine")
    with pytest.raises(UserError, match="at least 1"):
        write_library(tmp_path / "b.json", seed=1, count=0, name="mine")
    assert taken.read_text(encoding="utf-8") == "mine"
    assert list(tmp_path.iterdir()) == [taken]


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
    code = "import sys, faultpath.quadrotor.scenes.draw; sys.exit('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
