"""The smallest difference that a paired comparison would have detected.

Reported beside every "not detected", because not detecting a difference is not equivalence. It is
that of the rule which decides: the test at the level that its family leaves it, and the interval.
"""

from collections.abc import Callable

import numpy as np

from faultpath.statistics.distributions import clopper_pearson_upper, t_power
from faultpath.statistics.effect import Effect
from faultpath.statistics.estimate import SCENES_AND_SEEDS, Detectable
from faultpath.statistics.inputs import Floats, Numbers, paired_binary
from faultpath.statistics.power import rule_power, simulated_power
from faultpath.statistics.score import SceneValues

_PRECISION = 1e-4


def detectable(
    first: Numbers, second: Numbers, *, alpha: float = 0.05, power: float = 0.8
) -> Detectable:
    """Return the detectable difference in success (pp) of binary arms [scenes, seeds]."""
    one, two = paired_binary(first, second)
    n_seeds = one.shape[1]
    scenes = SceneValues.paired((one - two).sum(axis=1) / n_seeds, 1.0, 100.0)
    return _detectable(scenes, n_seeds, alpha, power)


def detectable_effect(effect: Effect, *, alpha: float = 0.05, power: float = 0.8) -> Detectable:
    """Return the detectable size of an effect that `compare` can test, differences included."""
    if effect.estimand == SCENES_AND_SEEDS:
        return _by_seeds(effect, alpha, power)
    if effect.scenes is None or effect.scenes.centre:
        raise ValueError(f"an effect in {effect.unit} by {effect.method} has no test")
    return _detectable(effect.scenes, effect.n_seeds, alpha, power)


def _detectable(scenes: SceneValues, n_seeds: int, alpha: float, power: float) -> Detectable:
    n_scenes = len(scenes.values)
    observed = np.abs(scenes.values[scenes.values != 0]) / scenes.bound
    notes: list[str] = []
    rate = len(observed) / n_scenes
    if not len(observed):
        rate = clopper_pearson_upper(0, n_scenes)
        notes.append(f"no scene differs; at most {100.0 * rate:.1f} % do (Clopper-Pearson)")
    kinds, times = np.unique(observed if len(observed) else np.ones(1), return_counts=True)
    model = _Scenes(n_scenes, rate, kinds, times / times.sum(), alpha)
    difference = _least(lambda size: model.power(size) >= power)
    if not model.whole:
        notes.append(f"a differing scene differs by {model.pp(scenes):.0f} pp on average")
    if difference is not None and difference > model.rate * model.mean_size:
        notes.append("more scenes differ than observed, all on one side")
    scale = scenes.scale * scenes.bound
    return Detectable(
        value=None if difference is None else scale * difference,
        reason=None
        if difference is not None
        else f"with {n_scenes} scenes the test cannot reject at {alpha:.2g} with power {power:g}, "
        "whatever the difference",
        alpha=alpha,
        power=power,
        method=f"power of {'exact McNemar' if n_seeds == 1 else 'the sign test'} and the score "
        f"interval, {'exact' if model.whole else 'simulated'}",
        n_scenes=n_scenes,
        n_seeds=n_seeds,
        discordant_rate=rate,
        note="; ".join(notes) or None,
    )


class _Scenes:
    """Scenes that differ as the observed ones do, and lean as a given difference needs."""

    def __init__(
        self, n_scenes: int, rate: float, sizes: Floats, shares: Floats, alpha: float
    ) -> None:
        self.n_scenes, self.rate, self.alpha = n_scenes, rate, alpha
        self.sizes, self.shares = sizes, shares
        self.mean_size = float(sizes @ shares)
        self.whole = bool((sizes == 1.0).all())

    def pp(self, scenes: SceneValues) -> float:
        return scenes.scale * scenes.bound * self.mean_size

    def power(self, difference: float) -> float:
        """Return the power at a difference, a fraction of the largest possible one.

        The share of differing scenes is the observed one; a difference that needs more has all of
        them on one side, and where all scenes do not suffice they differ by more.
        """
        rate = min(1.0, max(self.rate, difference / self.mean_size))
        if self.whole:
            return rule_power(self.n_scenes, rate, min(difference, rate), self.alpha)
        lean = min(1.0, difference / (rate * self.mean_size))
        sizes, shares = self.sizes, self.shares
        if difference > self.mean_size:
            larger = (difference - self.mean_size) / (1.0 - self.mean_size)
            sizes = np.append(sizes, 1.0)
            shares = np.append(shares * (1.0 - larger), larger)
        return simulated_power(self.n_scenes, sizes, rate * shares, lean, 1.0, self.alpha)


def _by_seeds(effect: Effect, alpha: float, power: float) -> Detectable:
    """Return what the t test of the seeds' effects detects, by the noncentral t distribution."""
    seeds = np.asarray(effect.per_seed)
    spread = float(seeds.std(ddof=1)) if len(seeds) > 1 else 0.0
    value = None
    if spread > 0.0:
        error = spread / float(np.sqrt(len(seeds)))
        largest = 1e6 * error
        share = _least(lambda size: t_power(len(seeds), size * largest / error, alpha) >= power)
        value = None if share is None else share * largest
    return Detectable(
        value=value,
        reason="the seeds' effects do not vary" if value is None else None,
        unit=effect.unit,
        alpha=alpha,
        power=power,
        method="power of the t test of the seeds' effects",
        n_scenes=effect.n_scenes,
        n_seeds=effect.n_seeds,
    )


def _least(reaches: Callable[[float], bool]) -> float | None:
    """Return the least difference between 0 and 1 that reaches the power; None when none does."""
    if not reaches(1.0):
        return None
    low, high = 0.0, 1.0
    while high - low > _PRECISION * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reaches(middle) else (middle, high)
    return high
