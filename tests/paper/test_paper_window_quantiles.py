"""Quantiles over windows: what they are, and that whole scenes are resampled."""

from typing import Any, cast

import numpy as np
import pytest
from faultpath_paper.evidence.table import Measured, Measurement, Recording
from faultpath_paper.quantities.windows import WindowQuantiles, median
from faultpath_paper.results import Results

from faultpath.core.streams import generator
from faultpath.stats.contrast import change

FEW = {"n_resamples": 400}


def quantile_estimate(values, scenes, q=0.5, *, unit="", **few):
    return WindowQuantiles(scenes, **few).value(values, q, unit).estimate()


def quantile_difference(first, second, scenes, **few):
    drawn = WindowQuantiles(scenes, **few)
    return change(drawn.value(second, 0.5), drawn.value(first, 0.5))


def windows(n_scenes=20, each=8):
    """Return values and scenes; windows of a scene lie close together."""
    stream = generator("test-windows", "clustered", 0)
    level = stream.normal(size=(n_scenes, 1))
    values = np.exp(level + 0.1 * stream.normal(size=(n_scenes, each)))
    scenes = [f"s{i:02d}" for i in range(n_scenes) for _ in range(each)]
    return values.reshape(-1), scenes


@pytest.mark.parametrize("q", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("each", [1, 7, 8])
def test_the_value_is_the_quantile_of_all_windows(q, each):
    values, scenes = windows(each=each)
    found = quantile_estimate(values, scenes, q, unit="m", **FEW)
    assert found.value == np.quantile(values, q, method="averaged_inverted_cdf")
    assert found.unit == "m"
    assert found.n_scenes == 20
    assert quantile_estimate(values, scenes, 0.5, **FEW).value == np.median(values)


def test_draws_are_the_quantiles_of_the_windows_of_the_resampled_scenes_in_any_order():
    values, scenes = windows(n_scenes=6, each=5)
    order = generator("test-order", "clustered", 0).permutation(len(values))
    drawn = WindowQuantiles([scenes[i] for i in order], n_resamples=30)
    draws = drawn.value(values[order], 0.5).draws
    by_scene = values.reshape(6, 5)
    for draw, counts in zip(draws, drawn.resamples.counts, strict=True):
        repeated = np.repeat(by_scene, counts.astype(int), axis=0)
        assert draw == np.median(repeated)


def test_seeds_are_averaged_after_their_quantiles():
    recording = Recording(library="held-out", variant="dki")
    (_, scenes), table = windows(), {}
    for seed in range(3):
        values = generator("test-windows", "seeds", seed).normal(size=len(scenes))
        own = Measurement(recording=recording, quantity="position-error", subject="dki", seed=seed)
        table[own] = Measured(tuple(scenes), np.arange(len(scenes)), values)
    errors = median(tuple(table))(Results(cast(Any, None), table, ""))
    assert errors.per_seed == tuple(np.median(part.values) for part in table.values())
    assert errors.value == pytest.approx(np.mean(errors.per_seed), abs=1e-8)
    assert errors.n_seeds == 3


def test_a_difference_is_paired_and_mirrors_when_the_variants_are_swapped():
    values, scenes = windows()
    noise = windows()[0][::-1]
    same = quantile_difference(values, values, scenes, **FEW)
    assert (same.value, same.interval) == (0.0, (0.0, 0.0))
    shifted = quantile_difference(values + 0.5, values, scenes, **FEW)
    assert shifted.interval == pytest.approx((0.5, 0.5))
    forth = quantile_difference(values, noise, scenes, **FEW)
    back = quantile_difference(noise, values, scenes, **FEW)
    low, high = forth.interval
    assert (back.value, back.interval) == (-forth.value, (-high, -low))


@pytest.mark.parametrize(
    "ask",
    [
        lambda values, scenes: quantile_estimate(values[:-1], scenes),
        lambda values, scenes: quantile_estimate(np.full_like(values, np.nan), scenes),
        lambda values, scenes: quantile_difference(values, values[:-1], scenes),
        lambda values, scenes: WindowQuantiles([]),
    ],
)
def test_what_has_no_quantile_is_refused(ask):
    with pytest.raises(ValueError, match=r"."):
        ask(*windows())
