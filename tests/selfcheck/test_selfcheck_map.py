"""Simulated maps are drawn as stated, announce next to nothing, and hold the true correlation."""

import numpy as np
import pytest

from faultpath.plane.lattice import COARSE, lattice
from faultpath.plane.model import Flip
from faultpath.selfcheck import check_map, failures
from faultpath.selfcheck.model import Report
from faultpath.selfcheck.plane import (
    EqualMaps,
    Scenes,
    Truths,
    holds,
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


def test_maps_of_equal_arms_announce_next_to_nothing() -> None:
    place, correlation = EqualMaps(25, 0.0, 10).measure()
    assert place.rate <= 0.26  # .05, and three standard errors
    assert correlation.rate <= 0.26
    assert (place.setting["of"], correlation.setting["of"]) == ("place", "correlation")


def test_places_that_hardly_depend_on_each_other_announce_no_more() -> None:
    assert EqualMaps(25, None, 10).measure()[0].rate <= 0.26


def test_with_the_level_of_one_place_maps_announce_what_is_not_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("faultpath.plane.decide.simultaneous", lambda *_: 1.96)
    assert EqualMaps(25, None, 8).measure()[0].rate > 0.5


def test_what_is_true_is_covered_and_a_turn_is_found() -> None:
    rates = {
        (each.section, each.setting.get("straight")): each.rate
        for each in Truths(100, 0.7, 10).measure()
    }
    assert min(rates["break-even correlation", straight] for straight in (0, 1)) >= 0.7
    assert rates["turning sizes", 1] >= 0.8
    assert rates["turning sizes found", None] >= 0.2


def test_a_false_word_on_a_path_is_seen() -> None:
    found = Scenes.draw(np.random.default_rng(0), 100, 0.5, equal=False).differences(
        list(lattice(COARSE))
    )
    right = Flip(
        path="second",
        direction=1,
        start=-1,
        turned=1,
        until=0.2,
        estimate=None,
        first=0.5,
        last=1.0,
    )
    assert holds(right, found, straight=False)
    assert not holds(right.model_copy(update={"until": 0.3}), found, straight=False)
    assert not holds(right.model_copy(update={"first": 0.25}), found, straight=False)
    assert not holds(right.model_copy(update={"turned": -1}), found, straight=False)
    assert holds(right.model_copy(update={"start": 0, "until": None}), found, straight=False)
    # The truth that is straight from the middle to half way turns further in.
    assert not holds(right, found, straight=True)
    assert holds(right.model_copy(update={"until": 0.15}), found, straight=True)
    shared = right.model_copy(update={"path": "shared", "turned": 0, "first": None, "last": None})
    assert holds(shared.model_copy(update={"until": 1.0}), found, straight=True)


@pytest.mark.slow
def test_the_quick_profile_keeps_every_promise() -> None:
    quick = check_map("quick")
    assert failures(quick) == []
    assert [section.name for section in quick.sections] == [
        "equal maps",
        "break-even correlation",
        "turning sizes",
        "decided places",
        "turning sizes found",
    ]
    assert Report.model_validate_json(quick.text()) == quick
