"""Every figure of the paper that follows from its own counts must come out of this layer."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from faultpath_paper.quantities.summaries import spearman
from paired import conditional_effect

from faultpath.report.sentences import wording
from faultpath.stats.breakeven import break_even
from faultpath.stats.contrast import change, percentile_interval
from faultpath.stats.decisions import with_test
from faultpath.stats.distributions import sign_p_value
from faultpath.stats.resamples import Resamples

PUBLISHED = yaml.safe_load((Path(__file__).parent / "published.yaml").read_text())
SCENES = PUBLISHED["scenes"]
CONTRASTS = PUBLISHED["contrasts"]
RESAMPLES = Resamples.draw("published", SCENES, n_resamples=4000)


def split(text):
    return tuple(int(part) for part in text.split(":"))


def variants(counts, *, overlap):
    """Binary variants with these counts per seed, scenes overlapping between seeds much or little.

    The paper prints counts per seed, not which scenes they are. Overlap of wins with wins gives the
    widest interval that the counts allow, avoiding it the narrowest.
    """
    total = np.zeros(SCENES)
    columns = []
    for wins, losses in map(split, counts):
        ascending = np.argsort(total, kind="stable")
        column = np.zeros(SCENES)
        most, least = ascending[::-1][:wins], ascending[:losses]
        if not overlap:
            most, least = ascending[:wins], ascending[::-1][:losses]
        column[most], column[least] = 1, -1
        total += column
        columns.append(column)
    difference = np.stack(columns, axis=1)
    return difference > 0, difference < 0


def widest(counts):
    """Return the effect of counts with the widest interval that they allow."""
    return conditional_effect(*variants(counts, overlap=True), RESAMPLES)


@pytest.mark.parametrize("name", CONTRASTS)
def test_differences_counts_and_intervals_of_tables_2_and_4(name):
    """Intervals lie between the widest and the narrowest possible, up to 0.7 pp, two steps of the
    resampled mean, for the paper's own resampling noise."""
    counts, (low, high) = CONTRASTS[name]["counts"], CONTRASTS[name]["ci95"]
    effect = widest(counts)
    assert round(effect.value, 1) == CONTRASTS[name]["pp"]
    assert wording.won(effect.won) == "/".join(counts)
    narrowest = conditional_effect(*variants(counts, overlap=False), RESAMPLES)
    outer, inner = (percentile_interval(found.draws) for found in (effect, narrowest))
    assert outer[0] - 0.7 <= low <= inner[0] + 0.7
    assert inner[1] - 0.7 <= high <= outer[1] + 0.7


@pytest.mark.parametrize("row", PUBLISHED["interactions"])
def test_interaction_of_table_4(row):
    a, b = (widest(CONTRASTS[row[k]]["counts"]) for k in "ab")
    assert round(change(a, b).value, 1) == row["pp"]


@pytest.mark.parametrize("row", PUBLISHED["decision_record"])
def test_break_even_frequencies_of_table_5(row):
    correct, faulty = (widest(CONTRASTS[row[k]]["counts"]) for k in ("correct", "faulty"))
    result = break_even(correct, faulty)
    if row["p_star"] is None:
        assert result.p_star is None
        assert [(r.low, r.high, r.sign) for r in result.regions] == [(0.0, 1.0, -1)]
    else:
        assert round(100 * result.p_star) == row["p_star"]
        ((low, high),) = result.pieces
        assert low <= result.p_star <= high
        assert result.regions[-1].sign == 1


@pytest.mark.parametrize("row", PUBLISHED["mcnemar"])
def test_mcnemar_p_values_of_table_6(row):
    first_only, second_only = split(row["counts"])
    assert round(sign_p_value(first_only, second_only), 3) == row["p"]
    assert first_only - second_only == row["success"][0] - row["success"][1]
    found = with_test(widest([row["counts"]]))
    assert wording.won(found.won) == row["counts"]
    assert found.test.p_value == sign_p_value(first_only, second_only)


def test_state_noise_cost_is_detected():
    row = PUBLISHED["state_noise"]
    found = with_test(widest([row["counts"]]))
    assert found.test.rejects() is row["detected"]
    assert found.value == pytest.approx(row["success"][0] - row["success"][1])


def test_rank_correlation_over_nine_cells():
    row = PUBLISHED["correlation"]
    result = spearman(np.array(row["analytic_error"]), np.array(row["success"]))
    assert round(result, 2) == row["spearman"]
