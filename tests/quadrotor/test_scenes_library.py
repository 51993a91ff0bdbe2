"""The frozen libraries: what they contain, that they are feasible, intact and reproducible."""

import math
import subprocess
import sys
from itertools import pairwise

import pytest
from faultpath_quadrotor.scenes.library import frozen_file, load_library
from faultpath_quadrotor.scenes.prisms import floor_plan, prism

from faultpath.core.errors import UserError


def test_asking_for_an_unknown_library_lists_what_there_is():
    with pytest.raises(UserError, match=r"'heldout'.*training, selection, held-out"):
        load_library("heldout")


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (lambda text: text.replace('"index":50,', '"index":51,', 1), "was changed"),
        (lambda text: text[: len(text) // 2], "cannot be read as a library"),
        (lambda text: "[1, 2]", "cannot be read as a library"),
        (lambda text: text.replace('"radius_m":0.', '"radius_m":-0.', 1), "cannot be read"),
        (lambda text: text.replace("scenes/1", "scenes/9"), "format 'faultpath-scenes/9'"),
    ],
)
def test_a_damaged_file_is_refused_in_one_sentence(tmp_path, damage, reason):
    path = tmp_path / "scenes.json"
    path.write_text(damage(frozen_file("training").read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(UserError, match=rf"scenes\.json.*{reason}") as caught:
        load_library(path)
    assert "\n" not in str(caught.value)


def test_a_floor_plan_has_every_solid_and_the_free_variant_none():
    for scene in load_library("selection").scenes[:10]:
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
