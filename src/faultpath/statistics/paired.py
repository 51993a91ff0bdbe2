"""Exact tests for paired arms (paper, "Interventions and Evidence" and "Statistical Aggregation").

Scenes are the unit of inference. One seed: exact McNemar. Several seeds: differences are averaged
over the seeds within each scene, and a sign test looks at the scene means.
"""

import numpy as np

from faultpath.statistics.distributions import sign_mid_p_value, sign_p_value
from faultpath.statistics.estimate import Discordant, SeedCounts, TestResult
from faultpath.statistics.inputs import Floats, Numbers, paired, paired_binary


def discordant_by_seed(first: Numbers, second: Numbers) -> SeedCounts:
    """Count per seed the scenes in which only one of two binary arms [scenes, seeds] succeeded."""
    one, two = paired_binary(first, second)
    difference = one - two
    return SeedCounts(
        per_seed=tuple(
            Discordant(
                first_only=int((column > 0).sum()),
                second_only=int((column < 0).sum()),
                n_pairs=len(column),
            )
            for column in difference.T
        )
    )


def discordant(first: Numbers, second: Numbers) -> Discordant:
    """Count the scenes in which only one of two single-seed binary arms ([scenes]) succeeded."""
    counts = discordant_by_seed(first, second).per_seed
    if len(counts) != 1:
        raise ValueError(
            f"McNemar needs one seed, got {len(counts)}: pairs that share a scene are not "
            "independent; use sign_test, which averages seeds within each scene"
        )
    return counts[0]


def mcnemar_exact(counts: Discordant) -> TestResult:
    """Exact two-sided McNemar test: is a discordant pair equally likely to favour either arm?

    Without discordant pairs p is 1.
    """
    return TestResult(
        name="exact McNemar",
        p_value=sign_p_value(counts.first_only, counts.second_only),
        counts=counts,
        n_scenes=counts.n_pairs,
    )


def mcnemar_mid_p(counts: Discordant) -> TestResult:
    """Two-sided mid-p McNemar test: the exact p less half of the observed outcome's weight a side.

    Less conservative than the exact test, at the price of a guarantee (Fagerland, Lydersen and
    Laake, BMC Medical Research Methodology 13:91, 2013).
    """
    return TestResult(
        name="mid-p McNemar",
        p_value=sign_mid_p_value(counts.first_only, counts.second_only),
        counts=counts,
        n_scenes=counts.n_pairs,
    )


def scene_totals(first: Numbers, second: Numbers) -> Floats:
    """Return [scenes]: first minus second, summed over the seeds of each scene.

    A sum that differs from 0 by rounding alone is set to 0, so that it counts as a tie.
    """
    one, two = paired(first, second)
    difference = one - two
    total = difference.sum(axis=1)
    total[np.abs(total) <= 1e-12 * (np.abs(one) + np.abs(two)).sum(axis=1)] = 0.0
    return total


def sign_counts(first: Numbers, second: Numbers) -> Discordant:
    """Count the scenes whose difference, averaged over seeds, favours the first or second arm."""
    total = scene_totals(first, second)
    return Discordant(
        first_only=int((total > 0).sum()),
        second_only=int((total < 0).sum()),
        n_pairs=len(total),
    )


def sign_test(first: Numbers, second: Numbers) -> TestResult:
    """Two-sided exact sign test on scene means of arms [scenes, seeds]; scenes with mean 0 drop.

    With one seed of binary outcomes it is the exact McNemar test. Works on distances and times too.
    """
    counts = sign_counts(first, second)
    return TestResult(
        name="sign test on scene means",
        p_value=sign_p_value(counts.first_only, counts.second_only),
        counts=counts,
        n_scenes=counts.n_pairs,
        n_seeds=np.shape(first)[1] if np.ndim(first) == 2 else 1,
    )


def success_test(first: Numbers, second: Numbers) -> TestResult:
    """Apply the paper's test to binary arms: exact McNemar for one seed, else the sign test."""
    one, two = paired_binary(first, second)
    return mcnemar_exact(discordant(one, two)) if one.shape[1] == 1 else sign_test(one, two)
