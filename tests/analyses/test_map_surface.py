"""The surface between the points, what is decided on it, and which points come next."""

import numpy as np
import pytest
from map_toys import MODULES, differences, grown, reversal

from faultpath.analyses.map.lattice import (
    COARSE,
    SHOWN,
    UNITS,
    along,
    corners,
    cut,
    first_turn,
    lattice,
    rays,
    sizes,
    surface_weights,
)
from faultpath.analyses.map.surface import Combined, simultaneous
from faultpath.stats.effects import success_effect

PLACES = lattice(SHOWN)
FINER = (*lattice(COARSE), *cut((0, 0), COARSE), *cut((8, 8), 8))


def test_the_surface_is_what_was_measured_at_a_point_and_a_mean_elsewhere() -> None:
    weights = surface_weights(FINER)
    assert (weights >= 0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1)
    for column, point in enumerate(FINER):
        assert weights[PLACES.index(point), column] == 1


@pytest.mark.parametrize("turned", [lambda x, y: (y, x), lambda x, y: (-x, y)])
def test_exchanging_the_modules_or_the_sign_of_an_error_turns_the_surface(turned) -> None:
    weights = surface_weights(FINER)
    other = surface_weights(tuple(turned(*point) for point in FINER))
    order = [PLACES.index(turned(*place)) for place in PLACES]
    np.testing.assert_allclose(other[order], weights)


def test_decisions_at_a_point_are_those_of_its_own_score_interval() -> None:
    found = differences(reversal(60), lattice(COARSE))
    all_ = Combined.of(np.eye(25), found)
    low, high = all_.ends(1.959963984540054)
    for i in (0, 4, 12, 20):
        effect = success_effect(found.repair[i], found.baseline[i], test="conditional")
        assert effect.interval == pytest.approx((low[i], high[i]), abs=1e-6)
        assert effect.value == pytest.approx(all_.means[i])


def test_copies_of_a_seed_decide_nothing_more() -> None:
    points = lattice(COARSE)
    one, two = differences(reversal(40), points), differences(reversal(40), points, seeds=3)
    weights = np.eye(25)
    assert simultaneous(weights, one, "toy") == simultaneous(weights, two, "toy")
    np.testing.assert_array_equal(*(Combined.of(weights, f).signs(2.5) for f in (one, two)))


def test_cells_are_cut_where_the_sign_is_not_decided_and_nowhere_else() -> None:
    found = grown(reversal(100))
    weights = np.eye(len(found.points))
    signs = Combined.of(weights, found).signs(simultaneous(weights, found, "toy"))
    of = dict(zip(found.points, signs, strict=True))
    on_conditions = {along(way, size) for way in rays(MODULES).values() for size in range(UNITS)}
    settled = 0
    for cell in [(x, y) for x, y in lattice(COARSE) if max(x, y) < UNITS]:
        finer = set(cut(cell, COARSE)) & of.keys()
        if {of[corner] for corner in corners(cell, COARSE)} in ({1}, {-1}):
            settled += 1
            assert (cell[0] + COARSE // 2, cell[1] + COARSE // 2) not in of.keys() - on_conditions
        else:
            assert len(finer) == 5
    assert settled


def test_the_first_turn_of_a_condition_is_bisected_to_one_unit() -> None:
    def seen(x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
        # Ahead at 0; behind where the first error is above 0.3 of the largest.
        return np.full(30, x <= 0.3), np.full(30, x > 0.3)

    found = grown(seen, 25)
    known = sizes((1, 0), found.points)
    turn = first_turn(known, [found.mean((size, 0)) for size in known])
    assert turn == (9, 10)
    assert turn[0] < 0.3 * UNITS <= turn[1]
    assert sizes((-1, 0), found.points) == (0, 16, 32)
    assert sizes((1, 1), found.points) == tuple(sorted({*known}))
