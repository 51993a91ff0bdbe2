"""The E+M test against enumerating every table by its definition, and against exact McNemar."""

import tracemalloc
from itertools import pairwise, product
from math import comb, sqrt

import numpy as np
import pytest
from simulation_many import largest_level

from faultpath.stats import unconditional
from faultpath.stats.decisions import with_test
from faultpath.stats.distributions import sign_p_value
from faultpath.stats.effects import success_effect
from faultpath.stats.many_pairs import ManyPairs
from faultpath.stats.null_law import NullLaw, bounds
from faultpath.stats.power import rule_power
from faultpath.stats.score import quantile, rejects


def tables(n):
    """Return every table of n pairs: how many first alone and second alone."""
    return [(b, d - b) for d in range(n + 1) for b in range(d + 1)]


def chances(n, share):
    """Return the chance of each table under no difference, where `share` of pairs is discordant."""
    ways = [comb(n, b + c) * comb(b + c, b) for b, c in tables(n)]
    apart = np.array(tables(n)).sum(axis=1)
    return np.array(ways, float) * (share / 2) ** apart * (1 - share) ** (n - apart)


def by_definition(n):
    """Return the E step's p of every table, by Lloyd's definition and nothing else."""
    z = np.array([abs(b - c) / sqrt(b + c) if b + c else 0.0 for b, c in tables(n)])
    laws = [chances(n, d / n) for d in range(n + 1)]
    apart = [b + c for b, c in tables(n)]
    return np.array([laws[d][z >= own - 1e-9].sum() for d, own in zip(apart, z, strict=True)])


@pytest.mark.parametrize("n", [1, 2, 10, 30])
def test_p_values_are_those_of_the_definition_and_keep_their_level(n):
    """Of every table; the maximum is looked for on another grid."""
    grid = np.unique(np.append(np.linspace(0.0, 1.0, 401), np.arange(n + 1) / n))
    laws = np.array([chances(n, share) for share in grid])
    e_step = by_definition(n)
    ours = np.array([unconditional.p_value(b, c, n) for b, c in tables(n)])
    assert ours.tolist() == [unconditional.p_value(c, b, n) for b, c in tables(n)]
    for own, p in zip(e_step, ours, strict=True):
        expected = min(1.0, (laws @ (e_step <= own * (1.0 + 1e-9))).max())
        assert p == pytest.approx(expected, rel=2e-3)
        assert p >= expected * (1.0 - 1e-7)  # as near as the maximum is looked for
    for alpha in (0.05, 0.025, 0.05 / 6, 0.001):
        assert (laws @ (ours <= alpha)).max() <= alpha


def test_of_a_hundred_pairs_it_agrees_with_tangos_interval_nearly_everywhere():
    """What the documents say: where each test and the interval disagree, level, and power."""
    first, second = np.array(tables(100)).T
    total, fewer = first + second, np.minimum(first, second)
    em = fewer <= unconditional.critical(100, 0.05)[1][total]
    exact = np.array([sign_p_value(b, c) for b, c in zip(first, second, strict=True)]) <= 0.05
    counts = np.stack([second, 100 - total, first], axis=1).astype(float)
    interval = rejects(np.array([-1.0, 0.0, 1.0]), counts, 0.0, np.ones(len(em)), quantile(0.95))
    assert len(em) == 5151
    assert (em != interval).sum() == 12
    assert (exact != interval).sum() == 94
    levels = [chances(100, share)[em].sum() for share in np.linspace(0.0, 1.0, 51)]
    assert 0.049 < max(levels) < 0.0498
    # 5 % of pairs discordant, all of them on one side: the power of test and interval together.
    power = [rule_power(100, 0.05, 0.05, test=test) for test in ("conditional", "unconditional")]
    assert power == pytest.approx([0.38, 0.74], abs=5e-3)


@pytest.mark.parametrize(("n", "alpha"), [(7, 0.05), (40, 0.05), (40, 0.05 / 6), (100, 0.025)])
def test_the_critical_counts_are_where_p_passes_the_level(n, alpha):
    for total, critical in enumerate(unconditional.critical(n, alpha)[1].tolist()):
        for fewer in range(max(0, critical - 1), min(critical + 2, total // 2) + 1):
            p = unconditional.p_value(total - fewer, fewer, n)
            assert (p <= alpha) == (fewer <= critical)


@pytest.mark.parametrize("alpha", [0.05, 0.0125, 1e-4])
def test_of_many_pairs_the_level_holds_and_is_used_and_p_agrees_with_the_region(alpha):
    """Of more pairs than E is summed for; levels by SciPy's binomial."""
    n = 4 * unconditional.MOST_SUMMED
    assert 0.98 * alpha < largest_level(n, alpha, shares=200) <= alpha
    critical = unconditional.critical(n, alpha)[1]
    for total in (12, 60, 256, 257, 400, n // 2, n - 1, n):
        for fewer in range(max(0, critical[total] - 1), critical[total] + 2):
            p = unconditional.p_value(total - fewer, fewer, n)
            assert (p <= alpha) == (fewer <= critical[total])


def test_of_many_pairs_p_is_nearly_that_of_the_summed_e_step():
    n = 1200
    summed, many = NullLaw(n), ManyPairs(n)
    for total, apart in product((20, 257, 600, n), (1.5, 2.1, 3.5)):
        z = (total - 2 * round((total - apart * sqrt(total)) / 2)) / sqrt(total)
        one, other = (
            law.worst(law.region(float(law.chance(*tables)[0]), *bounds(n)))
            for law in (summed, many)
            for tables in [(np.array([z]), np.array([float(total)]))]
        )
        assert other == pytest.approx(one, rel=0.02)


def test_hundred_thousand_pairs_take_no_table_of_their_square():
    """Four times the pairs, at most some eight times the memory."""
    peaks = []
    for n in (25_000, 100_000):
        tracemalloc.start()
        unconditional.p_value(n // 10, n // 11, n)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 9 * peaks[0]
    assert peaks[1] < 3e8


@pytest.mark.parametrize(("n", "named"), [(1000, "E+M (Lloyd)"), (1001, "E+M (Lloyd), normal E")])
def test_the_name_says_where_e_is_approximated(n, named):
    first = np.zeros((n, 1))
    first[:40] = 1
    assert with_test(success_effect(first, 0 * first)).test.name == named


def test_more_of_the_same_side_has_a_smaller_p_and_very_many_pairs_do_not_underflow():
    more = [unconditional.p_value(b, 2, 100) for b in range(2, 60)]
    assert all(one > two for one, two in pairwise(more))
    assert unconditional.p_value(1400, 0, 1500) == pytest.approx(0.0, abs=1e-300)
