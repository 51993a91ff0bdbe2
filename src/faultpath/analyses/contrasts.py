"""The contrasts of an audit: effects, changes, and their shares of the error rate."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faultpath.analyses.compared import Outcomes, paired_scenes
from faultpath.analyses.model import CORRECT, SHARED
from faultpath.stats.contrast import Contrast, change
from faultpath.stats.decisions import with_test
from faultpath.stats.effects import success_effect
from faultpath.stats.inputs import Floats


@dataclass(frozen=True)
class Measure:
    """How success under one condition becomes a contrast."""

    models: bool
    sequential: bool

    def effect(self, repair: Floats, baseline: Floats) -> Contrast:
        """Return the effect over the scenes of which a pair has both outcomes."""
        return success_effect(repair, baseline, models=self.models, sequential=self.sequential)

    def together(self, one: Outcomes, two: Outcomes) -> tuple[Contrast, Contrast] | None:
        """Return the effects under two conditions over the scenes, and for newly trained models the
        trainings, that both have; nothing where these are too few."""
        kept = paired_scenes(*one) & paired_scenes(*two)
        ends = [(repair[kept], baseline[kept]) for repair, baseline in (one, two)]
        if self.models:
            ran = [~np.isnan(repair - baseline).all(axis=0) for repair, baseline in ends]
            ends = [(a[:, ran[0] & ran[1]], b[:, ran[0] & ran[1]]) for a, b in ends]
        if not kept.any() or ends[0][0].shape[1] < 1 + self.models:
            return None
        return self.effect(*ends[0]), self.effect(*ends[1])

    def contrasts(
        self, success: Mapping[str, Outcomes], alone: Mapping[str, Outcomes], tested: Sequence[str]
    ) -> Iterator[tuple[str, Contrast]]:
        """Yield the tested effects, and their changes from those `alone` to the shared one, by
        name."""
        for condition in tested:
            yield effect_name(condition), self.effect(*success[condition])
        for condition in isolated(tested):
            if ends := self.together(alone[condition], success[SHARED]):
                yield change_name(condition), change(*ends)

    def tested(self, contrasts: Iterator[tuple[str, Contrast]]) -> dict[str, Contrast]:
        """Return contrasts by name, each with its test."""
        return {name: with_test(contrast) for name, contrast in contrasts}


def default_primary(primary: str, conditions: Collection[str]) -> str:
    """Return the primary condition: as named, else the shared one, else the isolated."""
    alone = [name for name in conditions if name not in (CORRECT, SHARED)]
    return primary or (SHARED if SHARED in conditions else (alone or list(conditions))[0])


def alpha_shares(conditions: Collection[str], primary: str) -> dict[str, float]:
    """Return each contrast's share of the error rate, by its name, where they are not equal.

    The effect under the primary condition, for which sequential audits stop, has a half; all others
    share the rest. Where that condition has none, the others' shares are equal.
    """
    named = [*map(effect_name, conditions), *map(change_name, isolated(conditions))]
    others = [name for name in named if name != effect_name(primary)]
    shares = dict.fromkeys(others, 0.5 / max(1, len(others)))
    return {effect_name(primary): 0.5 if others else 1.0, **shares}


def effect_name(condition: str) -> str:
    """Name the effect under a condition among the contrasts of a family."""
    return f"effect/{condition}"


def change_name(condition: str) -> str:
    """Name the change from an isolated condition to the shared one, likewise."""
    return f"change/{condition}"


def isolated(tested: Collection[str]) -> list[str]:
    """Return the conditions of which the change to the shared one is tested."""
    return (
        [condition for condition in tested if condition not in (CORRECT, SHARED)]
        if SHARED in tested
        else []
    )
