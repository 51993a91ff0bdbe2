"""The simulations of `make statistics` sample what they say, and the promises are kept."""

import numpy as np
import pytest
import simulation as simulated
import simulation_page
from paired import counted
from simulation import Population, kept
from simulation_blanks import blanks
from simulation_skewed import skewed_coverage

from faultpath.stats import unconditional
from faultpath.stats.breakeven import break_even
from faultpath.stats.effects import success_effect

pytestmark = pytest.mark.slow  # all together

ALPHA = 0.05


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
    assert np.abs(outcomes).mean() == pytest.approx(0.3, abs=0.006)


def test_two_conditions_keep_their_own_chances():
    one, two = Population(0.1, -1.0, 3, 0.5), Population(0.3, 0.2, 3)
    both = simulated.joint(one, two, 0.4)
    np.testing.assert_allclose(both.sum(axis=1), one.chances())
    np.testing.assert_allclose(both.sum(axis=0), two.chances())


def test_exact_coverage_is_that_of_the_intervals_themselves():
    """Every table of six scenes, through the interval that users see."""
    population = Population(0.4, 0.5)
    minus, none, plus = population.chances()
    expected = 0.0
    for second, equal, first in simulated.tables(6).astype(int):
        chance = 720 * minus**second * none**equal * plus**first
        for count in (second, equal, first):
            chance /= float(np.prod(np.arange(1, count + 1)))
        low, high = success_effect(*counted(first, second, 6)).interval
        expected += chance * (low <= 100 * population.mean <= high)
    assert simulated.interval_coverage(6, population) == pytest.approx(expected)


def test_break_even_coverage_is_that_of_the_sets_themselves(monkeypatch):
    """In the same scenes, so it is the same number."""
    monkeypatch.setattr(simulated, "generator", lambda *_: np.random.default_rng(1))
    correct, faulty = Population(0.1, -1.0), Population(0.3, 1.0)
    chances = simulated.joint(correct, faulty, 0.5).ravel()
    covered = 0
    for counts in np.random.default_rng(1).multinomial(40, chances, size=60):
        kinds = np.repeat(np.arange(9), counts)
        ends = [
            success_effect(difference > 0, difference < 0)
            for difference in (kinds // 3 - 1, kinds % 3 - 1)
        ]
        covered += any(low <= 0.1 / 0.4 <= high for low, high in break_even(*ends).pieces)
    assert simulated.break_even_coverage(40, correct, faulty, 60) == covered / 60 < 1


@pytest.mark.parametrize("seeds", [1, 3])
def test_intervals_cover_their_truth_where_few_scenes_differ_too(seeds):
    """2 % against 0 at 25 scenes: the percentile bootstrap covered it in .395 of cases."""
    for rate in (0.02, 0.3):
        found = simulated.interval_coverage(25, Population(rate, 1.0, seeds, 0.5 * (seeds > 1)))
        assert kept(found, 0 if seeds == 1 else 4000, least=0.93)


@pytest.mark.parametrize("lean", [-1.0, 0.0])
def test_a_break_even_frequency_near_zero_cost_is_covered(lean):
    """Resampled break-even frequencies covered it in .31 to .85 of cases."""
    faulty = Population(0.3, 1.0)
    found = simulated.break_even_coverage(50, Population(0.02, lean), faulty, 1000)
    assert kept(found, 1000, least=0.93)


def test_equal_variants_announce_next_to_nothing_and_no_reversal_is_made_up():
    """By signs of point estimates 44 % of audits had a reversal."""
    assert kept(
        simulated.equal_variants(100, Population(0.3, 0.0, 3, 0.5), 0.7, 150), 150, most=ALPHA
    )
    assert kept(simulated.reversals(100, 1, 0.0, runs=150), 150, most=0.025)
    assert simulated.reversals(100, 1, 0.2, runs=20) > 0.5


def test_equal_methods_are_not_told_apart_by_their_trainings():
    assert kept(simulated.trainings(100, 5, True, runs=300), 300, most=ALPHA)
    assert simulated.trainings(100, 5, False, runs=100) > 0.15


@pytest.mark.parametrize(("scenes", "seeds", "lost"), [(100, 3, 0.02), (300, 5, 0.005)])
def test_intervals_of_skewed_seeds_cover(scenes, seeds, lost):
    """With the reach of what was seen they covered in .888 to .924."""
    covered = skewed_coverage(scenes, seeds, 0.9, lost, 4000)
    assert kept(covered, 4000, least=0.93)


def test_failures_cost_other_conditions_nothing_and_reversals_little():
    """With 1 % failed, one scene in ten left every condition: .53 became .34."""
    assert simulated.beside_failures(0.05, 30) == simulated.beside_failures(0.0, 30)
    whole, failed = (simulated.reversals(60, 3, 0.14, share, 60) for share in (0.0, 0.01))
    assert failed > 0.7 * whole > 0.25


@pytest.mark.parametrize("seeds", [1, 3])
def test_a_difference_of_the_reported_size_is_detected_in_about_four_audits_of_five(seeds):
    found = simulated.detection(100, Population(0.1, 0.0, seeds, 0.5 * (seeds > 1)), ALPHA, 10)
    assert 0.7 < found < 0.9


def test_looks_after_every_scene_keep_their_promises():
    assert kept(simulated.any_look(100, Population(0.4, 0.0), 0.0, 30), 30, most=ALPHA)


def test_a_p_divided_by_four_breaks_a_promise(monkeypatch):
    """The simulations take the code that decides."""
    real = unconditional.p_value
    monkeypatch.setattr(unconditional, "p_value", lambda *given: real(*given) / 4)
    found = simulated.equal_variants(100, Population(0.3, 0.0), 0.0, 150)
    assert not kept(found, 150, most=ALPHA)


@pytest.mark.parametrize(("kind", "seeds"), [("one-sided", 1), ("repeated", 3), ("both", 1)])
def test_missing_trials_announce_nothing_and_move_no_break_even(kind, seeds):
    announced, wrong = blanks(kind, seeds, 25)
    assert kept(announced, 25, most=ALPHA)
    assert kept(wrong, 25, most=ALPHA)


def test_one_section_is_measured_alone_and_others_stay_to_the_byte(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    tables = {"One": "| 1 |", "Two": "| 2 |"}
    monkeypatch.setattr(
        simulation_page,
        "sections",
        lambda: [(title, str) for title in tables],
    )
    monkeypatch.setattr(simulation_page, "kept", lambda title, measured: tables[title])
    monkeypatch.setattr("sys.argv", ["", str(page)])
    simulation_page.main()
    before = page.read_text("utf-8")
    tables |= {"One": "| 3 |", "Two": "| 4 |"}
    monkeypatch.setattr("sys.argv", ["", str(page), "Two"])
    simulation_page.main()
    assert page.read_text("utf-8") == before.replace("| 2 |", "| 4 |")
    monkeypatch.setattr("sys.argv", ["", str(page), "Three"])
    with pytest.raises(SystemExit, match="'Three'"):
        simulation_page.main()
