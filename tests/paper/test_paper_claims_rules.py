"""Each rule of the claims: when it confirms, when it refutes, and when it leaves open."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from faultpath_paper.claims.rules import POINT_SCENES, Rule, rule_of
from faultpath_paper.claims.statement import Turned
from faultpath_paper.detection import Difference, least_detectable, resampled
from faultpath_paper.results import decisive

from faultpath.stats.contrast import Contrast, change, percentile_interval, weighted_sum
from faultpath.stats.decisions import with_test
from faultpath.stats.effects import mean_effect, success_effect
from faultpath.stats.estimate import PairedTest
from faultpath.stats.resamples import Resamples

Interval = tuple[float, float] | None
UP, DOWN, OPEN = (5.0, 15.0), (-15.0, -5.0), (-5.0, 15.0)
ABOVE, BELOW = rule_of("it is significantly above 0"), rule_of("it is significantly below 0")
NO_GAIN, NO_LOSS, NO_DIFFERENCE = (
    rule_of(f"it is not significantly {side} 0") for side in ("above", "below", "different from")
)
REPORTED = rule_of("reported: it")


def bounded(bound: str) -> Rule:
    return rule_of(f"it is {bound}")


def by_point(bound: str) -> Rule:
    return rule_of(f"it is {bound}, by the point estimate")


def within(least: float, most: float) -> Rule:
    return rule_of(f"it lies between {least:g} and {most:g}")


@dataclass(frozen=True, eq=False)
class WithLeast(Difference):
    mde: float | None = None
    """Least detectable difference, in place of the one that would be computed."""


@pytest.fixture(autouse=True)
def given_least(monkeypatch):
    def least(contrast: Contrast) -> float | None:
        return contrast.mde if isinstance(contrast, WithLeast) else least_detectable(contrast)

    monkeypatch.setattr("faultpath_paper.claims.rules.least_detectable", least)


def shown(value: float, interval: Interval, n_scenes=100, test=None, mde=None) -> Contrast:
    """Return a difference with this interval, of which 20 pp are telling."""
    draws = np.empty(0) if interval is None else np.repeat(interval, 50)
    return WithLeast(value, "pp", n_scenes, draws=draws, test=test, telling=20.0, mde=mde)


def found(interval: Interval, p_value: float | None = None, mde: float | None = 8.0) -> Contrast:
    """Return a difference at the middle of its interval, with a test that finds its side ahead."""
    value = 0.0 if interval is None else sum(interval) / 2
    test = None if p_value is None else PairedTest("sign", p_value, 1 if value > 0 else -1)
    return shown(value, interval, test=test, mde=mde)


@pytest.mark.parametrize(
    ("rule", "difference", "answer"),
    [
        # A difference is detected when interval and test agree.
        (ABOVE, found(UP, 0.01), "confirmed"),
        (ABOVE, found(DOWN, 0.01), "refuted"),
        (ABOVE, found(UP, 0.06), "undecided"),
        (ABOVE, found(OPEN, 0.01), "undecided"),
        (ABOVE, found(UP), "confirmed"),
        (ABOVE, found(None), "undecided"),
        (BELOW, found(DOWN, 0.01), "confirmed"),
        (BELOW, found((-5.0, 0.0), 0.01), "undecided"),
        # Not detecting counts only where something would have been seen.
        (NO_LOSS, found(OPEN, 0.3), "confirmed"),
        (NO_LOSS, found(DOWN, 0.01), "refuted"),
        (NO_LOSS, found((-15.0, 1.0), 0.04), "confirmed"),
        (NO_GAIN, found(UP, 0.01), "refuted"),
        (NO_DIFFERENCE, found(UP, 0.01), "refuted"),
        (NO_DIFFERENCE, found(DOWN, 0.01), "refuted"),
        (NO_DIFFERENCE, found(DOWN, 0.06), "confirmed"),
        (NO_LOSS, found(OPEN, 0.3, mde=20.0), "confirmed"),
        (NO_LOSS, found(OPEN, 0.3, mde=20.1), "undecided"),
        (NO_LOSS, found(OPEN, 0.3, mde=None), "undecided"),
        (NO_LOSS, found(None, 0.3), "undecided"),
        # A threshold is met by the estimate, and missed by the whole interval.
        (bounded("at least 10"), found(UP), "confirmed"),
        (bounded("at least 15"), found(UP), "undecided"),
        (bounded("at least 15.1"), found(UP), "refuted"),
        (bounded("below 4.9"), found(UP), "refuted"),
        (bounded("below 10"), found(UP), "undecided"),
        (bounded("below 10.1"), found(UP), "confirmed"),
        (bounded("at least 10 and significant"), found(UP, 0.01), "confirmed"),
        (bounded("at most -10 and significant"), found(DOWN, 0.01), "confirmed"),
        (bounded("at most -20"), found(DOWN, 0.01), "refuted"),
        (bounded("at least 10 and significant"), found(UP, 0.2), "undecided"),
        (bounded("at least 20 and significant"), found(UP, 0.01), "refuted"),
        (within(9, 11), found(UP), "confirmed"),
        (within(11, 12), found(UP), "undecided"),
        (within(16, 20), found(UP), "refuted"),
        (bounded("at least -1"), found(None), "undecided"),
        (within(-1, 1), found(None), "undecided"),
        # Claims about points are decided by points.
        (by_point("above 0"), shown(0.1, OPEN), "confirmed"),
        (by_point("above 0"), shown(0.0, OPEN), "undecided"),
        (by_point("at least 0"), shown(0.0, OPEN), "confirmed"),
        (by_point("below 0"), shown(0.1, OPEN), "refuted"),
        (by_point("at most -0.5"), shown(-0.5, OPEN), "confirmed"),
        (REPORTED, shown(-7.0, OPEN), "confirmed"),
        # Few scenes meet a threshold by their whole interval.
        (bounded("at least 8"), shown(10.0, UP, 10), "undecided"),
        (bounded("at least 4"), shown(10.0, UP, 10), "confirmed"),
        (within(8, 12), shown(10.0, UP, 10), "undecided"),
        (within(4, 16), shown(10.0, UP, 10), "confirmed"),
    ],
)
def test_a_rule_answers_by_value_interval_and_test(rule, difference, answer):
    assert rule.judge(difference).answer == answer


def test_words_that_end_in_no_rule_are_refused() -> None:
    for words in ("it is significantly above 1", "it is near 0", "it lies at 3"):
        with pytest.raises(ValueError, match="no rule ends in the words"):
            rule_of(words)


def test_of_several_seeds_the_interval_detects_and_the_test_may_fail_to() -> None:
    """As the paper has it: the sign test decides of an absence alone."""
    several = replace(found(UP, 0.3), n_seeds=3)
    vars(several)["least"] = 8.0
    assert ABOVE.judge(several).answer == "confirmed"
    assert BELOW.judge(several).answer == "refuted"
    assert NO_GAIN.judge(several).answer == "confirmed"
    assert bounded("at least 10 and significant").judge(several).answer == "confirmed"


@pytest.mark.parametrize("n_scenes", [1, POINT_SCENES - 1])
@pytest.mark.parametrize("rule", [by_point(bound) for bound in ("above 0", "below 0", "above 60")])
def test_few_scenes_decide_nothing_by_a_point_estimate(rule: Rule, n_scenes: int) -> None:
    for value in (-50.0, 0.0, 50.0):
        judged = rule.judge(shown(value, (value - 5, value + 5), n_scenes))
        assert judged.answer == "undecided"
        assert "scenes" in judged.reason


@pytest.mark.parametrize("rule", [ABOVE, BELOW])
@pytest.mark.parametrize("interval", [(0.0, 15.0), (-15.0, 0.0), (0.0, 0.0), OPEN])
@pytest.mark.parametrize("n_scenes", [10, 100])
def test_an_interval_that_reaches_0_says_nothing_about_the_side_of_0(rule, interval, n_scenes):
    difference = shown(sum(interval) / 2, interval, n_scenes)
    assert rule.judge(difference).answer == "undecided"


@pytest.mark.parametrize(
    "rule", [bounded("at least -60"), bounded("below 30"), within(1, 2), within(49, 51)]
)
@pytest.mark.parametrize("value", [0.0, 50.0, -50.0])
def test_an_interval_without_width_of_few_scenes_is_no_more_than_a_point(rule, value):
    difference = shown(value, (value, value), 10, mde=1.0)
    assert rule.judge(difference).answer == "undecided"


def effect(n: int, wins: int, losses: int) -> Contrast:
    """Return the tested difference of one seed with so many scenes won and lost."""
    scene = np.arange(n)
    variants = scene < wins, (scene >= wins) & (scene < wins + losses)
    return with_test(success_effect(*variants, Resamples.draw("scenes", n), test="conditional"))


N = 40


@pytest.mark.parametrize(
    ("before", "after", "answer"),
    [
        (effect(N, 20, 0), effect(N, 0, 20), "confirmed"),
        (effect(N, 20, 0), effect(N, 0, 0), "undecided"),
        (effect(N, 2, 0), effect(N, 0, 2), "undecided"),
        (effect(N, 40, 0), effect(N, 12, 0), "refuted"),
        (effect(N, 0, 20), effect(N, 0, 20), "refuted"),
        (effect(N, 4, 5), effect(N, 20, 0), "refuted"),
        (effect(5, 5, 0), effect(5, 0, 5), "undecided"),
    ],
)
def test_a_reversal_is_refuted_by_a_detected_sign_that_it_forbids(before, after, answer):
    assert Turned(decisive(change(before, after)), before, after).judge().answer == answer


def mean(values: list[float]) -> Contrast:
    array = np.array(values)
    return mean_effect(array, np.zeros_like(array), Resamples.draw("toy", len(values)), "m")


def test_the_least_detectable_effect_is_that_of_the_resamples() -> None:
    one = mean([0.1, 0.3, 0.7, 0.2, 0.9, 0.4, 0.6, 0.8])
    assert least_detectable(one) == pytest.approx(2.80 * one.draws.std(), rel=1e-3)
    assert least_detectable(mean([0.1] * 10)) is None
    gone = weighted_sum([0.1, 0.2, -0.3], [one, one, one])  # effects that cancel leave nothing
    assert gone.value == 0
    assert not gone.draws.any()


def test_a_difference_keeps_what_it_is_and_the_size_that_a_run_must_be_able_to_detect():
    few, many = mean([0.1, 0.9]), effect(N, 4, 0)
    assert (decisive(few, 0.2).telling, decisive(few).interval) == (0.2, None)
    kept = decisive(many, 20.0)
    assert (kept.telling, kept.interval, kept.test) == (20.0, many.interval, many.test)


def test_the_least_detectable_change_is_that_of_the_interval_that_decides():
    """The bootstrap of 25 equal scenes has no spread, and its change no detectable size."""
    drawn = Resamples.draw("claims", 25)
    variants = np.ones((25, 1), dtype=bool)
    effect = success_effect(variants, variants, drawn, test="conditional")
    found = decisive(change(effect, effect))
    assert found.interval is not None
    low, high = found.interval
    least = least_detectable(found)
    assert least == pytest.approx(2.8015852 * (high - low) / (2 * 1.959964), rel=1e-5)
    assert least > high


def test_the_percentile_interval_takes_the_place_of_the_score_interval():
    drawn = Resamples.draw("claims", 40, n_resamples=500)
    first, second = np.arange(40) < 12, np.arange(40) < 5
    effect = with_test(success_effect(first, second, drawn, test="conditional"))
    as_draws = resampled(effect)
    assert as_draws.interval == percentile_interval(effect.draws) != effect.interval
    for name in ("value", "test", "won"):
        assert getattr(as_draws, name) == getattr(effect, name)
    assert as_draws.estimate().method == "percentile bootstrap of scenes, 500 resamples"
    metres = mean_effect(first, second, drawn, "m")
    assert resampled(metres) is metres
