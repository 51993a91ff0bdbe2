"""What counts as found: interval and test together, within the family of all that is announced."""

from collections.abc import Mapping
from typing import Literal, TypeAlias

import numpy as np
from pydantic import Field

from faultpath.statistics.distributions import sign_p_value, t_p_value
from faultpath.statistics.effect import Effect
from faultpath.statistics.estimate import (
    SCENES_AND_SEEDS,
    Discordant,
    Estimate,
    FrozenResult,
    TestResult,
)

ALPHA = 0.05
Sign: TypeAlias = Literal[-1, 0, 1]


class Comparison(FrozenResult):
    """An effect with its interval and its test."""

    estimate: Estimate
    test: TestResult
    leans: Sign
    """Side of 0 that the test would find ahead, did it reject."""

    @property
    def agreed(self) -> Sign:
        """Return the side of 0 of the whole interval where the test leans to it, else 0."""
        return self.leans if self.leans == self.estimate.detected_sign else 0

    @property
    def side(self) -> Sign:
        """Return the side on which interval and test agree, at the level of this test alone."""
        return self.agreed if self.test.rejects(ALPHA) else 0


class Decision(FrozenResult):
    """What a family of comparisons makes of one of them."""

    sign: Sign
    """Side of 0 on which the effect is detected; 0 where it is not."""
    p_value: float = Field(ge=0.0, le=1.0)
    adjusted_p: float = Field(ge=0.0, le=1.0)
    """Holm's."""
    critical_p: float = Field(gt=0.0, lt=1.0)
    """What the test had to reach, given the others' p-values."""


def compare(effect: Effect) -> Comparison:
    """Return an effect with its test.

    For given models: exact McNemar (one seed), else the sign test on what scenes differ by, which
    is the paper's. For newly trained ones: the t test of the seeds' effects. ``ValueError`` for
    effects that have no test, as means and medians of unbounded outcomes.
    """
    if effect.estimand == SCENES_AND_SEEDS:
        return Comparison(
            estimate=effect.estimate(), test=_seed_test(effect), leans=_sign(effect.value)
        )
    if effect.scenes is None or effect.scenes.centre:
        raise ValueError(f"an effect in {effect.unit} by {effect.method} has no test")
    values = effect.scenes.values
    counts = _signs(values)
    single = "exact McNemar" if effect.n_seeds == 1 else "sign test on scene means"
    test = TestResult(
        name=single if effect.counts is not None else "sign test on scene differences",
        p_value=sign_p_value(counts.first_only, counts.second_only),
        counts=counts,
        n_scenes=effect.n_scenes,
        n_seeds=effect.n_seeds,
    )
    leans = _sign(counts.first_only - counts.second_only)
    return Comparison(estimate=effect.estimate(), test=test, leans=leans)


def decide_family(
    comparisons: Mapping[str, Comparison], alpha: float = ALPHA
) -> dict[str, Decision]:
    """Decide comparisons together: Holm's adjustment of all p-values given.

    An effect is detected when its adjusted p-value is at most ``alpha``, its interval excludes 0
    and both point the same way. So one or more false detections among all of them come in at most
    a share ``alpha`` of audits, whichever of the nulls are true.
    """
    p_values = {name: each.test.p_value for name, each in comparisons.items()}
    ordered = sorted(p_values, key=lambda name: p_values[name])
    adjusted: dict[str, float] = {}
    largest = 0.0
    for place, name in enumerate(ordered):
        largest = max(largest, min(1.0, (len(ordered) - place) * p_values[name]))
        adjusted[name] = largest
    return {
        name: Decision(
            sign=each.agreed if adjusted[name] <= alpha else 0,
            p_value=p_values[name],
            adjusted_p=adjusted[name],
            critical_p=_critical([p for other, p in p_values.items() if other != name], alpha),
        )
        for name, each in comparisons.items()
    }


def turn(
    isolated: Decision, shared: Decision, change: Decision
) -> Literal["reversal", "interaction", "none"]:
    """Say what sharing a fault does to an effect.

    A reversal is two effects detected on opposite sides of 0: an intersection-union test, so the
    change between them needs no further test. An interaction is a detected change without that.
    """
    if isolated.sign * shared.sign < 0:
        return "reversal"
    return "interaction" if change.sign else "none"


def fewest_scenes(hypotheses: int, alpha: float = ALPHA) -> int:
    """Return how many scenes a family needs at least for its tests to detect anything at all."""
    return int(np.ceil(1.0 + np.log2(hypotheses / alpha) - 1e-12))


def _critical(others: list[float], alpha: float) -> float:
    """Return the largest p-value that would be rejected beside these others."""
    rejected = 0
    for p in sorted(others):
        if p > alpha / (len(others) + 1 - rejected):
            break
        rejected += 1
    return alpha / (len(others) + 1 - rejected)


def _seed_test(effect: Effect) -> TestResult:
    seeds = np.asarray(effect.per_seed)
    # A share of n scenes is known to 1 / n only: rounding's own variance keeps equal seeds from
    # looking like certainty. Seeds that are copies of each other say nothing of new ones.
    rounding = (100.0 / effect.n_scenes) ** 2 / 12.0 if effect.unit == "pp" else 0.0
    return TestResult(
        name="t test of the seeds' effects",
        p_value=t_p_value(seeds, rounding),
        counts=_signs(seeds),
        n_scenes=effect.n_scenes,
        n_seeds=effect.n_seeds,
    )


def _signs(values: "np.ndarray[tuple[int, ...], np.dtype[np.float64]]") -> Discordant:
    return Discordant(
        first_only=int((values > 0).sum()),
        second_only=int((values < 0).sum()),
        n_pairs=len(values),
    )


def _sign(value: float) -> Sign:
    return 1 if value > 0 else -1 if value < 0 else 0
