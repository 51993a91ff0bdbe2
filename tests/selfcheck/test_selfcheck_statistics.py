"""The self-check of the statistics samples what it says, and names what is broken."""

import dataclasses

import numpy as np
import pytest

from faultpath.record.family import SHARED, alpha_shares
from faultpath.selfcheck import Report, check_statistics, failures, page
from faultpath.selfcheck.audits import PATHS, EqualArms, NoReversal, Trainings
from faultpath.selfcheck.coverage import BreakEvenCoverage, IntervalCoverage, ModelsCoverage, tables
from faultpath.selfcheck.detection import DetectionAtTheReported
from faultpath.selfcheck.populations import Population, joint
from faultpath.selfcheck.promises import PROMISES
from faultpath.selfcheck.records import Dying, Extended, Lopsided
from faultpath.selfcheck.sequential import AnyLook, EveryLook
from faultpath.statistics import Resamples, betting, break_even, success_effect, unconditional


@pytest.fixture(scope="module")
def quick() -> Report:
    return check_statistics("quick")


def test_the_quick_profile_keeps_every_promise(quick):
    assert failures(quick) == []
    assert {section.name for section in quick.sections} == {
        "interval",
        "break-even",
        "newly trained models",
        "detectable difference",
        "equal arms",
        "no reversal",
        "trainings",
        "lopsided arms",
        "dying trials",
        "extended audits",
        "sequential, equal arms",
        "sequential, p against interval",
        "sequential, coverage",
        "sequential, scenes taken",
        "sequential, decided",
    }
    assert Report.model_validate_json(quick.text()) == quick


def test_a_broken_promise_is_named_with_its_setting(quick):
    interval = quick.section("interval")
    place = interval.columns.index("measured")
    row = (*interval.rows[0][:place], 0.395, *interval.rows[0][place + 1 :])
    worse = interval.model_copy(update={"rows": (row, *interval.rows[1:])})
    broken = quick.model_copy(update={"sections": (worse, *quick.sections[1:])})
    (said,) = failures(broken)
    assert said.startswith("the 95 % interval of an effect covers the truth in 0.395 of cases")
    assert "scenes 25" in said
    assert f"- {said}" in page(broken, [said])


@pytest.mark.parametrize("effects", [False, True])
@pytest.mark.parametrize("alike", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("seeds", [1, 3])
def test_drawn_outcomes_have_the_stated_chances(seeds, alike, effects):
    population = Population(0.3, 0.5, seeds, alike, effects)
    outcomes = population.outcomes(np.random.default_rng(0).random((100_000, seeds + 2)))
    mean = outcomes.mean(axis=1)
    observed = [np.isclose(mean, size).mean() for size in population.sizes]
    np.testing.assert_allclose(observed, population.chances(), atol=0.006)
    assert float(population.sizes @ population.chances()) == pytest.approx(population.mean)
    assert mean.mean() == pytest.approx(population.mean, abs=0.006)
    assert np.abs(outcomes).mean() == pytest.approx(0.3, abs=0.006)


def test_two_conditions_keep_their_own_chances():
    one, two = Population(0.1, -1.0, 3, 0.5), Population(0.3, 0.2, 3)
    both = joint(one, two, 0.4)
    np.testing.assert_allclose(both.sum(axis=1), one.chances())
    np.testing.assert_allclose(both.sum(axis=0), two.chances())


def test_exact_coverage_is_that_of_the_intervals_themselves():
    """Every table of six scenes, through the interval that users see."""
    population = Population(0.4, 0.5)
    resamples = Resamples.draw("six", 6, n_resamples=1)
    minus, none, plus = population.chances()
    expected = 0.0
    for second, equal, first in tables(6).astype(int):
        chance = 720 * minus**second * none**equal * plus**first
        for count in (second, equal, first):
            chance /= float(np.prod(np.arange(1, count + 1)))
        scene = np.arange(6)
        arms = scene < first, (scene >= first) & (scene < first + second)
        low, high = success_effect(*arms, resamples).interval
        expected += chance * (low <= 100 * population.mean <= high)
    measured = IntervalCoverage(6, population, runs=0).measure()
    assert (measured.runs, measured.rate) == (0, pytest.approx(expected))


def test_break_even_coverage_is_that_of_the_sets_themselves():
    cell = BreakEvenCoverage(40, Population(0.1, -1.0), Population(0.3, 1.0), 400)
    p, rng = 0.1 / 0.4, np.random.default_rng(1)
    resamples = Resamples.draw("forty", 40, n_resamples=1)
    chances = joint(cell.correct, cell.faulty, 0.5).ravel()
    covered = 0
    for _ in range(400):
        kinds = rng.choice(9, size=40, p=chances)
        ends = [
            success_effect(difference > 0, difference < 0, resamples)
            for difference in (kinds // 3 - 1, kinds % 3 - 1)
        ]
        covered += any(low <= p <= high for low, high in break_even(*ends).pieces)
    error = np.sqrt(2 * 0.05 * 0.95 / 400)
    assert cell.measure().rate == pytest.approx(covered / 400, abs=4 * error)


def test_2_percent_against_0_at_25_scenes_is_covered():
    """The percentile bootstrap covered it in .395 of cases."""
    assert IntervalCoverage(25, Population(0.02, 1.0), 0).measure().rate > 0.93


@pytest.mark.parametrize("rate", [0.005, 0.02, 0.05])
def test_a_break_even_frequency_near_zero_cost_is_covered(rate):
    """Resampled break-even frequencies covered it in .31 to .85 of cases."""
    for lean in (-1.0, 0.0):
        cell = BreakEvenCoverage(50, Population(rate, lean), Population(0.3, 1.0), 1000)
        assert cell.measure().rate > 0.93 - 3 * np.sqrt(0.07 * 0.93 / 1000)


def test_no_reversal_is_announced_where_the_isolated_effect_is_nothing():
    """Isolated 0, shared -20 pp, 100 scenes: 44 % by point estimates."""
    assert NoReversal(100, 1, 0.0, 150).measure().rate <= 0.03
    assert NoReversal(100, 1, 0.2, 20).measure().rate > 0.5


def test_audits_of_equal_arms_announce_next_to_nothing():
    """Once 11 to 17 % of audits."""
    cell = EqualArms(100, Population(0.3, 0.0, 3, 0.5), 0.7, 150)
    assert cell.measure().rate <= 0.05 + 0.053  # three standard errors


def test_equal_methods_are_not_told_apart_by_their_trainings():
    """By these trainings alone .31 to .36 are, which is right of them and wrong of the methods."""
    assert Trainings(100, 3, "models", 300).measure().rate <= 0.05
    assert Trainings(100, 3, "scenes", 100).measure().rate > 0.15


@pytest.mark.parametrize("alpha", [0.05, 0.05 / 7])
def test_a_difference_of_the_reported_size_is_detected_in_four_audits_of_five(alpha):
    """It was .47 to .77."""
    found = DetectionAtTheReported(100, Population(0.1, 0.0), alpha, 25).measure()
    assert 0.75 < found.rate < 0.85
    assert found.runs == 0


def test_the_exact_power_at_the_reported_is_that_of_simulated_reports():
    cell = DetectionAtTheReported(25, Population(0.3, 0.0), 0.05, 200)
    simulated, runs = cell._simulated()
    error = np.sqrt(0.8 * 0.2 / runs)
    assert runs > 1000
    assert cell.measure().rate == pytest.approx(simulated, abs=4 * error)


def test_several_seeds_detect_what_was_reported_in_seven_audits_of_ten_at_least():
    found = DetectionAtTheReported(25, Population(0.3, 0.0, 3, 0.5), 0.05, 20).measure()
    assert found.rate > 0.7 - 3 * np.sqrt(0.7 * 0.3 / found.runs)
    assert found.runs > 20


@pytest.mark.parametrize("rate", [0.005, 0.02])
def test_newly_trained_models_are_covered_near_zero_discordance(rate):
    """The crossed bootstrap alone covered .26 to .61 of cases at 25 scenes."""
    assert ModelsCoverage(25, 3, rate, False, 60).measure().rate > 0.93


def test_a_setting_always_gives_the_same_rate():
    cell = IntervalCoverage(25, Population(0.1, 0.0, 3, 0.5), 200)
    assert cell.measure() == dataclasses.replace(cell).measure()


@pytest.mark.parametrize(
    ("code", "cell"),
    [
        (betting, AnyLook(60, Population(0.5, 0.0), 0.0, 15)),
        (unconditional, EqualArms(100, Population(0.3, 0.0), 0.0, 150)),
    ],
)
def test_a_p_divided_by_four_breaks_a_promise(code, cell, monkeypatch):
    """The simulations take the code that decides; they had their own, which a wrong p passed by."""

    def broken() -> bool:
        found = cell.measure()
        rates = found if isinstance(found, tuple) else (found,)
        return any(
            promise.broken({"measured": each.rate, "runs": each.runs})
            for each in rates
            for promise in PROMISES
            if promise.section == each.section
        )

    assert not broken()
    real = code.p_value

    def less(*given):
        p = real(*given)
        return (p[0] / 4, *p[1:]) if isinstance(p, tuple) else p / 4

    monkeypatch.setattr(code, "p_value", less)
    assert broken()


@pytest.mark.parametrize("gains", [0.3, 0.6])
def test_lopsided_arms_are_seldom_told_apart(gains):
    """By sign tests .07 to .18 were."""
    assert Lopsided(100, 3, gains, 100).measure().rate <= 0.046 + 0.063


def test_trials_that_die_announce_nothing_and_a_look_is_told():
    assert Dying(40, 1.0, 8).measure().rate <= 0.3
    announced, silent = Extended((30, 60), 6).measure()
    assert silent.rate <= announced.rate


def test_shares_of_the_error_rate_sum_to_all_of_it():
    for paths, primary in ((PATHS, SHARED), (PATHS, "predictor"), (("correct",), "correct")):
        shares = alpha_shares(paths, primary)
        assert sum(shares.values()) == pytest.approx(1.0)
        assert max(shares, key=lambda name: shares[name]) == f"effect/{primary}"
    assert len(alpha_shares(PATHS, SHARED)) == 6


def test_looks_after_every_scene_keep_their_promises():
    """The full profile is in the documents; here a few settings, at three standard errors."""
    population = Population(0.4, 0.0, 1)
    assert AnyLook(100, population, 0.0, 30).measure()[0].rate <= 0.05 + 0.12
    assert EveryLook(150, Population(0.4, 0.5), 400).measure().rate >= 0.95 - 0.033
