"""Exact tests against scipy and statsmodels, and the laws that they must keep."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.stats import binomtest
from statsmodels.stats.contingency_tables import mcnemar

from faultpath.statistics import Resamples, success_effect, with_test
from faultpath.statistics.distributions import sign_p_value

COUNT = st.integers(0, 60)
PAIR = hnp.arrays(np.bool_, st.tuples(st.just(2), st.integers(1, 30), st.integers(1, 4)))


@settings(deadline=None)
@given(COUNT, COUNT)
def test_exact_mcnemar_agrees_with_statsmodels_and_scipy(first_only, second_only):
    ours = sign_p_value(first_only, second_only)
    table = [[10, first_only], [second_only, 5]]
    assert ours == pytest.approx(mcnemar(table, exact=True).pvalue, abs=1e-12)
    if first_only + second_only:
        assert ours == pytest.approx(
            binomtest(first_only, first_only + second_only).pvalue, abs=1e-12
        )
    else:
        assert ours == 1.0


def found(first, second):
    """Return the tested contrast of two binary arms."""
    return with_test(
        success_effect(first, second, Resamples.draw("t", max(1, len(first)), n_resamples=1)),
        "exact",
    )


@settings(deadline=None)
@given(PAIR, st.integers(2, 4))
def test_duplicating_seeds_does_not_shrink_the_p_value(pair, times):
    copied = np.tile(pair, (1, 1, times))
    assert found(*copied).test.p_value == found(*pair).test.p_value


@settings(deadline=None)
@given(PAIR)
def test_one_seed_is_tested_by_exact_mcnemar(pair):
    one = pair[:, :, 0]
    table = [[0, int((one[0] & ~one[1]).sum())], [int((one[1] & ~one[0]).sum()), 0]]
    assert found(*one).test.name == "exact McNemar"
    assert found(*one).test.p_value == pytest.approx(mcnemar(table, exact=True).pvalue, abs=1e-12)


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        (np.ones((4, 2)), np.ones((4, 3)), "one shape"),
        (np.ones((0, 2)), np.ones((0, 2)), "no outcomes"),
        (np.ones((2, 2, 2)), np.ones((2, 2, 2)), "not 3-d"),
        (np.array([1.0, np.nan]), np.ones(2), "first holds NaN"),
        (np.ones(2), np.array([1.0, np.inf]), "second holds NaN or infinity"),
        (np.ones(2), np.array([1.0, 0.5]), "second must hold only 0 and 1"),
    ],
)
def test_wrong_input_is_refused(first, second, message):
    with pytest.raises(ValueError, match=message):
        found(first, second)
