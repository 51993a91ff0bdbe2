"""Sobol indices of groups: known ones are found, and intervals hold what they promise."""

import numpy as np
import pytest

from faultpath.statistics.sobol import design, indices


def test_the_indices_of_ishigami_s_function_are_found():
    """Its indices are known in closed form (Ishigami and Homma, 1990)."""
    x1, x2, x3 = (np.pi * (2.0 * design([1, 1, 1], 4096, 0) - 1.0)).T
    found = indices(np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1), 3, 0.95, 0)
    assert found is not None
    np.testing.assert_allclose(found.first, [0.3139, 0.4424, 0.0], atol=0.03)
    np.testing.assert_allclose(found.total, [0.5576, 0.4424, 0.2437], atol=0.03)
    assert (found.first_width < 0.1).all()


def test_a_group_has_the_index_of_its_numbers_together():
    """Of a + b + 2 c with a and b in one group: 2 to 4. Order of declaration is kept."""
    drawn = design([1, 2], 1024, 1)
    assert drawn.shape == (1024 * 4, 3)
    found = indices(2 * drawn[:, 0] + drawn[:, 1] + drawn[:, 2], 2, 0.95, 1)
    assert found is not None
    np.testing.assert_allclose(found.first, [4 / 6, 2 / 6], atol=0.02)
    np.testing.assert_allclose(found.total, [4 / 6, 2 / 6], atol=0.02)
    moved = drawn.reshape(-1, 4, 3)
    assert (moved[:, 2, 1:] != moved[:, 0, 1:]).all()
    assert (moved[:, 2, 0] == moved[:, 0, 0]).all()


def test_nothing_varies_is_none_and_the_global_random_state_stays():
    rows = len(design([1, 1], 64, 0))
    np.random.seed(1)  # noqa: NPY002 - what must not be drawn from
    before = np.random.get_state()[1].copy()  # noqa: NPY002
    assert indices(np.full(rows, 62.5), 2, 0.95, 0) is None
    values = design([1, 1], 64, 0)[:, 0]
    one, two = (indices(values, 2, 0.95, 0) for _ in range(2))
    np.testing.assert_array_equal(one, two)
    np.testing.assert_array_equal(np.random.get_state()[1], before)  # noqa: NPY002


@pytest.mark.parametrize("name", ["product", "sum", "distance", "failures"])
def test_with_the_fewest_points_all_intervals_hold_at_once(name: str) -> None:
    """With half as many points those of the product missed in a fifth of designs."""
    made, first, total = {
        "product": (lambda z: z[:, 0] * z[:, 1], [0.0] * 2, [1.0] * 2),
        "sum": (lambda z: z.sum(axis=1), [1 / 3] * 3, [1 / 3] * 3),
        "distance": (lambda z: np.abs(z.sum(axis=1)), [0.1] * 2, [0.9] * 2),
        "failures": (lambda z: 100.0 * (z > 0.4).any(axis=1), [9 / 19] * 2, [10 / 19] * 2),
    }[name]
    missed, designs = 0, 60
    for seed in range(designs):
        values = made(design([1] * len(first), 64, seed) - 0.5)
        found = indices(values, len(first), 1 - 0.05 / (2 * len(first)), seed)
        assert found is not None
        wide = 1e-9
        held = (np.abs(found.first - first) <= found.first_width + wide).all() and (
            np.abs(found.total - total) <= found.total_width + wide
        ).all()
        missed += not held
    assert missed <= 0.1 * designs
