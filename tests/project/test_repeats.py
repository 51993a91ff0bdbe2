"""What pages say of a stored run is so: the code that is here repeats a sample of its trials."""

import pytest
import references
import repeats
from blocks import Repeats, load

HERE = [
    name for name, run in references.by_time().items() if references.environment(run) == ".venv"
]
"""Runs whose packages are those of the tests; `make test-foreign` asks the others."""
OWN = {"toy", "dock", "map-toy", "scan-toy"}
"""Runs whose arithmetic is the same on every processor, as the quadrotor's is. The first two
are run as a whole by `test_readme_numbers`."""


@pytest.fixture
def thinned(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take every fourth trial of a sample: flights of one vehicle are much alike, and take time."""
    whole = repeats.sample
    monkeypatch.setattr(repeats, "sample", lambda *arguments: whole(*arguments)[::4])


@pytest.mark.parametrize("name", ["map-toy", "scan-toy"])
def test_a_sample_of_a_run_comes_out_as_its_page_says(name: str) -> None:
    run = load(name)
    assert repeats.repeat(run) == run.repeats


@pytest.mark.parametrize("name", [n for n in HERE if "quadrotor" in n])
def test_other_flights_come_out_as_their_page_says(name: str, thinned: None) -> None:
    run = load(name)
    result = repeats.repeat(run)
    assert run.repeats is not None
    assert result.trials == run.repeats.trials
    for count in ("repeated", "near"):
        share = getattr(run.repeats, count) / run.repeats.sampled
        assert share in (0.0, 1.0), "too few of the sample are taken here"
        assert getattr(result, count) == share * result.sampled


@pytest.mark.parametrize("name", [n for n in HERE if n not in OWN and "quadrotor" not in n])
def test_a_sample_of_a_run_on_libraries_that_choose_by_processor_is_near(name: str) -> None:
    """Where NumPy or torch choose by processor, single trials of a chaotic system may part."""
    run, result = load(name), repeats.repeat(load(name))
    assert run.repeats is not None
    assert result.sampled == run.repeats.sampled
    assert result.near >= 0.75 * run.repeats.near


def test_a_changed_constant_of_the_plant_is_named_by_the_trial_that_differs(
    monkeypatch, thinned
) -> None:
    compiled = pytest.importorskip("faultpath_quadrotor.plant.compiled")
    monkeypatch.setattr(compiled, "GRAVITY_MPS2", compiled.GRAVITY_MPS2 * 1.0001)
    result = repeats.repeat(load("quadrotor-L3"))
    assert result.repeated == 0
    assert not result.current
    assert "seed 0: other" in result.first
    assert "trajectory" in result.first


@pytest.mark.parametrize(
    ("repeated", "near", "current", "text"),
    [
        (8, 8, True, "; all 8 sampled of its 800 trials repeated to the bit by this version."),
        (
            5,
            8,
            True,
            "; 5 of 8 sampled of its 800 trials repeated to the bit by this version, the others "
            "within a thousandth.",
        ),
        (5, 7, False, "; this version gives other results in 1 of 8 sampled of its 800 trials."),
        (0, 0, False, "; this version gives other results in 8 of 8 sampled of its 800 trials."),
    ],
)
def test_a_page_says_how_many_trials_repeat(repeated, near, current, text) -> None:
    result = Repeats(trials=800, sampled=8, repeated=repeated, near=near)
    assert f"; {result}." == text
    assert result.current is current
