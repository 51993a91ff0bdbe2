"""Simulated maps are drawn as stated, announce next to nothing, and hold the true correlation."""

import numpy as np
import pytest

from faultpath.plane.lattice import COARSE, lattice
from faultpath.selfcheck import check_map, failures
from faultpath.selfcheck.model import Report
from faultpath.selfcheck.plane import (
    CorrelationCoverage,
    EqualMaps,
    Scenes,
    true_correlation,
    truth,
)


def test_drawn_scenes_have_the_stated_truth() -> None:
    points = lattice(COARSE)
    stream = np.random.default_rng(0)
    found = Scenes.draw(stream, 20_000, 0.5, equal=False).differences(points)
    np.testing.assert_allclose(found.values.mean(axis=1) / 100, truth(points), atol=0.015)
    equal = Scenes.draw(stream, 20_000, 0.5, equal=True).differences(points)
    np.testing.assert_allclose(equal.values.mean(axis=1), 0, atol=1.5)
    assert np.abs(equal.values).mean() > 5


def test_the_true_correlation_is_where_both_arms_do_equally_well() -> None:
    r = true_correlation()
    x, y = (
        np.random.default_rng(0)
        .multivariate_normal([0, 0], 0.16 * np.array([[1, r], [r, 1]]), 400_000)
        .T
    )
    seen = truth([(32 * a, 32 * b) for a, b in zip(x, y, strict=True)])  # type: ignore[misc] - fractions of a unit
    assert -1 < r < 1
    assert seen.mean() == pytest.approx(0, abs=0.002)


@pytest.mark.parametrize("of", ["place", "correlation"])
def test_maps_of_equal_arms_announce_next_to_nothing(of: str) -> None:
    assert EqualMaps(25, 0.0, of, 20).measure().rate <= 0.2  # .05, and three standard errors


def test_places_that_hardly_depend_on_each_other_announce_no_more() -> None:
    assert EqualMaps(25, None, "place", 10).measure().rate <= 0.26


def test_with_the_level_of_one_place_maps_announce_what_is_not_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("faultpath.selfcheck.plane.simultaneous", lambda *_: 1.96)
    assert EqualMaps(25, None, "place", 8).measure().rate > 0.5


@pytest.mark.parametrize("straight", [True, False])
def test_the_true_correlation_is_covered(straight: bool) -> None:
    assert CorrelationCoverage(25, 0.7, straight, 20).measure().rate > 0.85


@pytest.mark.slow
def test_the_quick_profile_keeps_every_promise() -> None:
    quick = check_map("quick")
    assert failures(quick) == []
    assert [section.name for section in quick.sections] == ["equal maps", "break-even correlation"]
    assert Report.model_validate_json(quick.text()) == quick
