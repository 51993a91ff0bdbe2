"""Joint errors, break-even correlation, turning sizes, and that nothing undecided is said."""

import re

import numpy as np
import pytest
from map_toys import FACTS, Seen, alike, concluded, differences, grown, record, reversal
from outcome_tables import SPOILS
from pydantic import ValidationError

from faultpath.analyses.map import decide
from faultpath.analyses.map.decide import Errors, lattice_weights
from faultpath.analyses.map.lattice import COARSE, SHOWN, UNITS, lattice, surface_weights
from faultpath.analyses.map.model import MapResult
from faultpath.analyses.map.surface import Combined, Differences
from faultpath.report.map import map_picture
from faultpath.report.sentences import words
from faultpath.report.sentences.maps import size_label

X, Y = np.array(lattice(SHOWN), dtype=float).T / UNITS
DECIDES = re.compile(r"(new|old) (is|does|is expected)")


@pytest.mark.parametrize("correlation", [-1.0, 0.6])
def test_the_expectation_of_a_bilinear_surface_is_that_of_its_moments(correlation: float) -> None:
    errors = Errors((0.1, -0.2), (0.15, 0.1))
    weights = lattice_weights(errors, correlation)
    assert weights.sum() == pytest.approx(1)
    assert weights @ X == pytest.approx(0.1, abs=1e-6)
    assert weights @ Y == pytest.approx(-0.2, abs=1e-6)
    assert weights @ (X * Y) == pytest.approx(correlation * 0.015 - 0.02, abs=2e-4)
    assert errors.outside(correlation) == 0


def test_the_break_even_correlation_is_where_the_expectation_is_zero() -> None:
    found = grown(reversal(100))
    made = record(reversal(100), spreads=(0.16, 0.16))
    (estimate,) = made.joint.estimates
    ((low, high),) = made.joint.undecided
    assert -1 < low < estimate < high < 1
    assert [region.sign for region in made.joint.regions] == [1, -1]
    weights = lattice_weights(Errors((0.0, 0.0), (0.4, 0.4)), estimate)
    expected = Combined.of((weights @ surface_weights(found.points))[np.newaxis], found)
    assert expected.means[0] == pytest.approx(0, abs=0.1)


@pytest.mark.parametrize("sign", [1, -1])
def test_of_many_scenes_each_side_keeps_its_correlations(sign: int) -> None:
    """The undecided part between them was narrower than the grid, and one side had all of it."""

    def seen(x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
        return np.full(1000, x * y > 0.02), np.full(1000, x * y < -0.02)

    turned = differences(lambda x, y: seen(x, y)[::sign], lattice(COARSE))
    joint = decide.joint(FACTS.model_copy(update={"means": (0.05, 0.03)}), turned)
    (estimate,), ((low, high),) = joint.estimates, joint.undecided
    assert low < estimate < high < low + 0.025
    regions = [(region.low, region.high, region.sign) for region in joint.regions]
    assert regions == [(-1.0, low, -sign), (high, 1.0, sign)]


def test_swapping_the_variants_swaps_the_record() -> None:
    found = grown(reversal(60))
    one = concluded(found)
    two = concluded(Differences(found.points, found.baseline, found.repair))
    assert [p.sign for p in one.points] == [-p.sign for p in two.points]
    assert [r.sign for r in one.joint.regions] == [-r.sign for r in two.joint.regions]
    np.testing.assert_allclose(one.joint.undecided, two.joint.undecided)
    assert [(f.until, f.first, -f.start) for f in one.flips] == [
        (f.until, f.first, f.start) for f in two.flips
    ]


@pytest.mark.parametrize("scenes", [1, 2, 4])
def test_nothing_is_said_to_be_decided_of_a_few_scenes(scenes: int) -> None:
    made = record(reversal(scenes))
    assert words(made).headline.startswith(f"Too few scenes: {scenes} compared")
    assert not DECIDES.search(" ".join((words(made).headline, *words(made).sentences)))
    assert not any(point.sign for point in made.points)
    assert made.joint.regions == ()
    assert made.joint.undecided == ((-1.0, 1.0),)


def test_nothing_is_said_to_be_decided_of_ties() -> None:
    made = record(alike(40))
    assert not any(point.sign for point in made.points)
    assert [flip.estimate for flip in made.flips] == [None] * 6


MAPS = {"a reversal": reversal(100), "two scenes": reversal(2), "ties": alike(40)}


@pytest.mark.parametrize("name", MAPS)
def test_what_is_said_is_what_was_approved(name: str, approved) -> None:
    made = record(MAPS[name], spreads=(0.16, 0.16))
    approved(name, "\n".join((words(made).headline, "", *words(made).sentences)))


def _weak(strong: int, sign: int) -> Seen:
    """A repair that wins 8 of 60 scenes and loses 2 at each pair of errors, other ones each time,
    and at a few pairs most."""
    points = lattice(COARSE)

    def seen(x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
        place = points.index((round(x * UNITS), round(y * UNITS)))
        order = np.random.default_rng(place).permutation(60)
        won = 40 if place in (12, 7)[:strong] else 8
        return (order < won, (order >= won) & (order < won + 2))[::sign]

    return seen


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("strong", [0, 1, 2])
def test_ahead_is_said_only_at_pairs_of_errors_that_were_run(strong: int, sign: int) -> None:
    """The average over errors can leave out 0 where no pair of errors does."""
    made = concluded(differences(_weak(strong, sign), lattice(COARSE)))
    assert sum(point.sign == sign for point in made.points) == strong
    assert {region.sign for region in made.joint.regions} == {sign}
    winner = "new" if sign > 0 else "old"
    said = (
        f"{winner} is ahead at {strong} of 25 pairs of errors; elsewhere neither is significantly "
        "ahead."
    )
    if not strong:
        said = "At none of 25 pairs of errors is the difference significant."
    assert words(made).headline == said


def test_where_one_version_is_ahead_at_all_pairs_nothing_is_said_of_others() -> None:
    made = concluded(differences(lambda x, y: (np.ones(60), np.zeros(60)), lattice(COARSE)))
    assert words(made).headline == "new is ahead at 25 of 25 pairs of errors."


def test_no_error_has_no_sign() -> None:
    facts = record(alike(8)).facts.model_copy(update={"relative": False, "unit": "m"})
    assert [size_label(facts, size) for size in (0.0, 0.2, -0.2)] == ["0 m", "+0.2 m", "−0.2 m"]
    assert size_label(facts.model_copy(update={"unit": "m/s^2"}), 1.0) == "+1 m/s²"
    for unit in ("", "1"):
        assert size_label(facts.model_copy(update={"unit": unit}), 1.0) == "+1"


def test_long_numbers_stand_beside_the_frame_of_a_map() -> None:
    made = record(alike(8), relative=False, unit="m/s^2", up_to=123456.789)
    drawn = map_picture(made).render()
    ends = re.findall(r'class="small soft" x="([\d.]+)" y="[\d.]+" text-anchor="end">', drawn)
    assert len(ends) == 5
    assert len(set(ends)) == 1, "none was moved in, onto the frame"
    assert "error at the observer, m/s²" in drawn


@pytest.mark.parametrize("name", ["sizes", "difference", "sign"])
def test_a_surface_has_a_row_and_a_column_for_each_size(name: str) -> None:
    held = record(alike(8)).model_dump()
    whole = held["surface"][name]
    for odd in ((), whole[:-1], [whole[0][:-1], *whole[1:]] if name != "sizes" else whole * 2):
        held["surface"][name] = odd
        with pytest.raises(ValidationError, match="has not a row and a column for each size"):
            MapResult.model_validate(held)


def test_every_claim_of_a_condition_is_one_of_its_points() -> None:
    made = record(reversal(100))
    of = {point.errors: point for point in made.points}
    observer = next(f for f in made.flips if (f.condition, f.direction) == ("observer", 1))
    assert (observer.start, observer.turned) == (-1, 1)
    assert observer.until is not None
    assert observer.first is not None
    assert observer.estimate is not None
    assert 0 <= observer.until < observer.estimate < observer.first <= 0.4
    assert {(observer.until, 0.0), (observer.first, 0.0)} <= set(of)
    for (x, y), point in of.items():
        if y == 0 and 0 <= x <= observer.until:
            assert point.sign == -1
        if y == 0 and observer.first <= x <= (observer.last or 0):
            assert point.sign == 1
    shared = next(f for f in made.flips if (f.condition, f.direction) == ("shared", -1))
    assert (shared.until, shared.estimate, shared.first) == (-0.4, None, None)


def test_a_place_between_points_is_claimed_nowhere() -> None:
    """A ridge between the points: the surface was 5.6 pp off, and its band covered in .38."""

    def ridge(x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
        place = np.random.default_rng(int(1000 * (x + 2) + 10 * (y + 2))).random((2, 100))
        return place[0] < 0.7 - 0.25 * abs(x), place[1] < 0.8 - 0.35 * abs(x - y)

    result = concluded(differences(ridge, lattice(COARSE)))
    text = " ".join((words(result).headline, *words(result).sentences))
    assert not re.search(r"correlat\w* .*(does better|is ahead|succeed)", text)
    run = {x or y for x, y in (point.errors for point in result.points)}
    assert {flip.until for flip in result.flips} | {flip.first for flip in result.flips} <= {
        *run,
        None,
    }


@pytest.mark.parametrize("invalid", ["unrepeatable", "unpaired"])
def test_a_map_of_trials_on_which_nothing_rests_claims_nothing(invalid) -> None:
    result = concluded(grown(reversal(100)), SPOILS[invalid])
    assert words(result).headline.startswith("No result: ")
    assert words(result).sentences == ()
    assert not any(point.sign for point in result.points)
    assert not any(flip.start or flip.turned for flip in result.flips)
