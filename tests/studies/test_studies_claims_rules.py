"""Each rule of the claims: when it confirms, when it refutes, and when it leaves open."""

import numpy as np
import pytest

from faultpath.statistics import (
    Contrast,
    Resamples,
    change,
    mean_effect,
    success_effect,
    weighted_sum,
)
from faultpath.statistics.estimate import PairedTest
from faultpath.studies.claims.record import Crossing, NeverPays, PaysFrom
from faultpath.studies.claims.reversals import Turn, TurnsDown
from faultpath.studies.claims.rules import (
    ABOVE,
    BELOW,
    NO_GAIN,
    NO_LOSS,
    REPORTED,
    ByPoint,
    NotDetected,
    Rule,
    Within,
    at_least,
    less_than,
    more_than,
)
from faultpath.studies.quantities.found import POINT_SCENES, Found, of_effect

UP, DOWN, OPEN = (5.0, 15.0), (-15.0, -5.0), (-5.0, 15.0)


def found(
    interval: tuple[float, float] | None, p_value: float | None = None, mde: float | None = 8.0
) -> Found:
    """Return a difference at the middle of its interval, with a test that finds its side ahead."""
    value = 0.0 if interval is None else sum(interval) / 2
    test = None if p_value is None else PairedTest("sign", p_value, 1 if value > 0 else -1)
    return Found(value, interval, "pp", 100, test, mde, telling_mde=20.0)


@pytest.mark.parametrize(
    ("rule", "shown", "answer"),
    [
        (ABOVE, found(UP, 0.01), "confirmed"),
        (ABOVE, found(DOWN, 0.01), "refuted"),
        (ABOVE, found(OPEN, 0.3), "undecided"),
        (ABOVE, found(UP, 0.06), "undecided"),
        (ABOVE, found(OPEN, 0.01), "undecided"),
        (ABOVE, found(UP), "confirmed"),
        (ABOVE, found(None), "undecided"),
        (BELOW, found(DOWN, 0.01), "confirmed"),
        (BELOW, found(UP, 0.01), "refuted"),
        (BELOW, found((-5.0, 0.0), 0.01), "undecided"),
    ],
)
def test_a_difference_is_detected_when_interval_and_test_agree(
    rule: Rule[Found], shown: Found, answer: str
) -> None:
    assert rule.judge(shown).answer == answer


@pytest.mark.parametrize(
    ("rule", "shown", "answer"),
    [
        (NO_LOSS, found(OPEN, 0.3), "confirmed"),
        (NO_LOSS, found(DOWN, 0.01), "refuted"),
        (NO_LOSS, found((-15.0, 1.0), 0.04), "refuted"),
        (NO_LOSS, found(UP, 0.01), "confirmed"),
        (NO_GAIN, found(UP, 0.01), "refuted"),
        (NotDetected(), found(UP, 0.01), "refuted"),
        (NotDetected(), found(DOWN, 0.01), "refuted"),
        (NotDetected(), found(DOWN, 0.06), "confirmed"),
        (NO_LOSS, found(OPEN, 0.3, mde=20.0), "confirmed"),
        (NO_LOSS, found(OPEN, 0.3, mde=20.1), "undecided"),
        (NO_LOSS, found(OPEN, 0.3, mde=None), "undecided"),
        (NO_LOSS, found(DOWN), "refuted"),
        (NO_LOSS, found(None, 0.3), "undecided"),
    ],
)
def test_not_detecting_counts_only_where_something_would_have_been_seen(
    rule: Rule[Found], shown: Found, answer: str
) -> None:
    assert rule.judge(shown).answer == answer


@pytest.mark.parametrize(
    ("rule", "shown", "answer"),
    [
        (at_least(10), found(UP), "confirmed"),
        (at_least(10.1), found(UP), "undecided"),
        (at_least(15), found(UP), "undecided"),
        (at_least(15.1), found(UP), "refuted"),
        (less_than(4.9), found(UP), "refuted"),
        (more_than(10), found(UP), "undecided"),
        (more_than(15), found(UP), "undecided"),
        (more_than(15.1), found(UP), "refuted"),
        (less_than(10), found(UP), "undecided"),
        (less_than(10.1), found(UP), "confirmed"),
        (at_least(10, detected=True), found(UP, 0.01), "confirmed"),
        (at_least(10, detected=True), found(UP, 0.2), "undecided"),
        (at_least(3, detected=True), found(OPEN, 0.2), "undecided"),
        (at_least(20, detected=True), found(UP, 0.01), "refuted"),
        (Within(9, 11), found(UP), "confirmed"),
        (Within(11, 12), found(UP), "undecided"),
        (Within(16, 20), found(UP), "refuted"),
        (Within(1, 2), found(UP), "refuted"),
        (at_least(-1), found(None), "undecided"),
        (Within(-1, 1), found(None), "undecided"),
    ],
)
def test_a_threshold_is_met_by_the_estimate_and_missed_by_the_whole_interval(
    rule: Rule[Found], shown: Found, answer: str
) -> None:
    assert rule.judge(shown).answer == answer


@pytest.mark.parametrize(
    ("rule", "value", "answer"),
    [
        (ByPoint(1), 0.1, "confirmed"),
        (ByPoint(1), 0.0, "undecided"),
        (ByPoint(1, strict=False), 0.0, "confirmed"),
        (ByPoint(-1), 0.1, "refuted"),
        (ByPoint(-1, -0.5, strict=False), -0.5, "confirmed"),
        (ByPoint(-1, -0.5, strict=False), -0.4, "refuted"),
        (REPORTED, -7.0, "confirmed"),
    ],
)
def test_claims_about_points_are_decided_by_points(
    rule: Rule[Found], value: float, answer: str
) -> None:
    assert rule.judge(Found(value, OPEN, "pp", 100)).answer == answer


@pytest.mark.parametrize("n_scenes", [1, 5, 10, POINT_SCENES - 1])
@pytest.mark.parametrize("rule", [ByPoint(1), ByPoint(-1), ByPoint(1, 60), ByPoint(-1, 0.0)])
def test_few_scenes_decide_nothing_by_a_point_estimate(rule: Rule[Found], n_scenes: int) -> None:
    for value in (-50.0, 0.0, 50.0):
        judged = rule.judge(Found(value, (value - 5, value + 5), "pp", n_scenes))
        assert judged.answer == "undecided"
        assert "scenes" in judged.reason


TOUCHING = [(0.0, 15.0), (-15.0, 0.0), (0.0, 0.0), OPEN]


@pytest.mark.parametrize("rule", [ABOVE, BELOW, more_than(0), less_than(0), at_least(0)])
@pytest.mark.parametrize("interval", TOUCHING)
@pytest.mark.parametrize("n_scenes", [10, 100])
def test_an_interval_that_reaches_0_says_nothing_about_the_side_of_0(
    rule: Rule[Found], interval: tuple[float, float], n_scenes: int
) -> None:
    shown = Found(sum(interval) / 2, interval, "pp", n_scenes)
    assert rule.judge(shown).answer == "undecided"


@pytest.mark.parametrize(
    ("rule", "n_scenes", "answer"),
    [
        (at_least(8), 10, "undecided"),
        (at_least(8), 100, "confirmed"),
        (at_least(4), 10, "confirmed"),
        (at_least(16), 10, "refuted"),
        (Within(8, 12), 10, "undecided"),
        (Within(8, 12), 100, "confirmed"),
        (Within(4, 16), 10, "confirmed"),
        (Within(16, 20), 10, "refuted"),
    ],
)
def test_few_scenes_meet_a_threshold_by_their_whole_interval(
    rule: Rule[Found], n_scenes: int, answer: str
) -> None:
    assert rule.judge(Found(10.0, UP, "pp", n_scenes)).answer == answer


@pytest.mark.parametrize(
    "rule", [at_least(30), at_least(-60), less_than(30), Within(1, 2), Within(49, 51)]
)
@pytest.mark.parametrize("value", [0.0, 50.0, -50.0])
def test_an_interval_without_width_of_few_scenes_is_no_more_than_a_point(
    rule: Rule[Found], value: float
) -> None:
    shown = Found(value, (value, value), "pp", 10, mde=1.0, telling_mde=20.0)
    assert rule.judge(shown).answer == "undecided"


@pytest.mark.parametrize("sign", [1, -1])
def test_a_tie_shows_neither_side_ahead(sign: int) -> None:
    judged = ByPoint(sign).judge(Found(0.0, (0.0, 0.0), "pp", 100))
    assert (judged.answer, judged.reason) == ("undecided", "the estimate is a tie")


def turn(interval: tuple[float, float], before: int, after: int, *, differ: bool) -> Turn:
    value = sum(interval) / 2
    turned = differ and interval[1] < 0
    return Turn(value, interval, "pp", 40, before=before, after=after, turned=turned)


@pytest.mark.parametrize(
    ("shown", "answer"),
    [
        (turn(DOWN, 1, -1, differ=True), "confirmed"),
        (turn(DOWN, 0, 0, differ=True), "confirmed"),
        (turn(DOWN, 1, 0, differ=False), "undecided"),
        (turn(OPEN, 0, 0, differ=True), "undecided"),
        (turn(DOWN, 1, 1, differ=False), "refuted"),
        (turn(OPEN, -1, -1, differ=False), "refuted"),
        (turn(UP, 0, 0, differ=False), "refuted"),
    ],
)
def test_a_reversal_is_refuted_by_a_detected_sign_that_it_forbids(shown: Turn, answer: str) -> None:
    assert TurnsDown().judge(shown).answer == answer


def crossing(
    value: float | None, *, ahead: bool = False, behind: bool = False, never: bool = False
) -> Crossing:
    return Crossing(
        value=value,
        interval=None if value is None else (max(0.0, value - 10), value + 10),
        unit="percent",
        n_scenes=100,
        ahead=ahead,
        behind=behind,
        never=never,
    )


@pytest.mark.parametrize(
    ("rule", "shown", "answer"),
    [
        (PaysFrom(less_than(15)), crossing(5, ahead=True), "confirmed"),
        (PaysFrom(less_than(15)), crossing(20, ahead=True), "undecided"),
        (PaysFrom(less_than(15)), crossing(40, ahead=True), "refuted"),
        (PaysFrom(less_than(15)), crossing(0, ahead=True), "confirmed"),
        (PaysFrom(more_than(30)), crossing(0, ahead=True), "refuted"),
        (PaysFrom(more_than(30)), crossing(None, behind=True, never=True), "refuted"),
        (PaysFrom(more_than(30)), crossing(None, never=True), "undecided"),
        (PaysFrom(less_than(15)), crossing(None), "undecided"),
        (NeverPays(), crossing(None, never=True), "confirmed"),
        (NeverPays(), crossing(None, never=True, behind=True), "confirmed"),
        (NeverPays(), crossing(40), "undecided"),
        (NeverPays(), crossing(40, ahead=True), "refuted"),
    ],
)
def test_a_break_even_frequency_is_judged_by_what_is_decided(
    rule: PaysFrom | NeverPays, shown: Crossing, answer: str
) -> None:
    assert rule.judge(shown).answer == answer


@pytest.mark.parametrize("rule", [ABOVE, NO_LOSS, NotDetected(), at_least(3), ByPoint(1), REPORTED])
def test_a_statement_begins_with_its_subject(rule: Rule[Found]) -> None:
    assert "success of A minus B" in rule.words("success of A minus B")


def effect(values: list[float]) -> Contrast:
    array = np.array(values)
    return mean_effect(array, np.zeros_like(array), Resamples.draw("toy", len(values)), "m")


def test_the_least_detectable_effect_is_that_of_the_resamples() -> None:
    one = effect([float(i) for i in range(10)])
    assert of_effect(one).mde == pytest.approx(2.80 * one.draws.std(), rel=1e-3)


def test_what_does_not_vary_detects_nothing() -> None:
    assert of_effect(effect([0.1] * 10)).mde is None


def test_effects_that_cancel_leave_exactly_nothing() -> None:
    one = effect([0.1, 0.3, 0.7, 0.2, 0.9, 0.4, 0.6])
    gone = weighted_sum([0.1, 0.2, -0.3], [one, one, one])
    assert gone.value == 0
    assert not gone.draws.any()


def test_the_least_detectable_change_is_that_of_the_interval_that_decides():
    """The bootstrap of 25 equal scenes has no spread, and its change no detectable size."""
    drawn = Resamples.draw("claims", 25)
    arms = np.ones((25, 1), dtype=bool)
    found = of_effect(change(success_effect(arms, arms, drawn), success_effect(arms, arms, drawn)))
    assert found.interval is not None
    low, high = found.interval
    assert found.mde == pytest.approx(2.8015852 * (high - low) / (2 * 1.959964), rel=1e-5)
    assert found.mde > high
