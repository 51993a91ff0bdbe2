"""Success of two variants under each condition, pair by pair, and the contrasts that follow."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from faultpath.analyses.model import CORRECT, SHARED, where
from faultpath.core.errors import UserError
from faultpath.run.findings import Unpaired
from faultpath.run.pairing import Group, Pairs, pair
from faultpath.run.trials import Bools, Trials
from faultpath.stats.contrast import Contrast, change
from faultpath.stats.decisions import with_test
from faultpath.stats.effects import success_effect
from faultpath.stats.inputs import Floats

Outcomes: TypeAlias = tuple[Floats, Floats]
"""Success of the repair and of the baseline, each `[scenes, seeds]`: 1 or 0, and not a number where
a trial has no outcome."""


@dataclass(frozen=True)
class PairedTrials:
    """Trials that are compared, condition by condition, and conditions that are not."""

    pairs: Mapping[str, Pairs]
    """Under each condition of which a pair has both outcomes."""
    success: Mapping[str, Outcomes]
    """Under each of these, in every scene, by the seeds that count."""
    missing: tuple[str, ...]
    """Conditions of which no pair has."""
    unpaired: tuple[Unpaired, ...]
    """Pairs that met different conditions."""


def compared(repair: str, baseline: str, conditions: Iterable[str], trials: Trials) -> PairedTrials:
    """Return the trials of two variants that are compared; `UserError` when no pair is left.

    Each condition keeps its own scenes and seeds: what failed elsewhere costs it nothing. Where all
    seeds gave the same in everything, one counts.
    """
    pairs = {
        condition: pair(trials, Group(repair, condition), Group(baseline, condition))
        for condition in conditions
    }
    success = {condition: paired.success for condition, paired in pairs.items()}
    left = [condition for condition, ends in success.items() if paired_scenes(*ends).any()]
    if not left:
        row = int(np.flatnonzero(trials.failed)[0])
        place: list[int] = trials.places[row].tolist()
        variant, condition, _, scene = place
        why = f" ({trials.errors[row]})" if row in trials.errors else ""
        raise UserError(
            "no scene is left to compare, because in each of them a trial failed, such as that of "
            f"{trials.variants[variant]} in {trials.scenes[scene].id} "
            f"{where(trials.conditions[condition])}{why}: fix what made it fail, or choose "
            "other scenes."
        )
    columns = np.concatenate([part for condition in left for part in success[condition]])
    alike = np.array_equal(columns, np.repeat(columns[:, :1], columns.shape[1], 1), equal_nan=True)
    seeds = slice(1) if alike else slice(None)
    return PairedTrials(
        pairs={condition: pairs[condition] for condition in left},
        success={
            condition: (success[condition][0][:, seeds], success[condition][1][:, seeds])
            for condition in left
        },
        missing=tuple(condition for condition in pairs if condition not in left),
        unpaired=tuple(unlike for paired in pairs.values() for unlike in paired.unpaired),
    )


def paired_scenes(repair: Floats, baseline: Floats) -> Bools:
    """Return `[scenes]` whether any seed has both outcomes."""
    return np.asarray(~np.isnan(repair - baseline).all(axis=1), dtype=np.bool_)


@dataclass(frozen=True)
class Design:
    """How success under the conditions of an audit becomes contrasts."""

    models: bool
    """Whether it speaks of newly trained models as well."""
    sequential: bool
    """Whether the number of scenes was not fixed beforehand."""

    def effect(self, repair: Floats, baseline: Floats) -> Contrast:
        """Return the effect over the scenes with at least one complete pair.

        It has no test yet, which takes long where scenes are many.
        """
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
        self,
        tested: Sequence[str],
        success: Mapping[str, Outcomes],
        alone: Mapping[str, Outcomes] | None = None,
    ) -> dict[str, Contrast]:
        """Return the effects under the `tested` conditions, and their changes from the isolated to
        the shared one, by name and with their tests. Changes begin at the outcomes `alone` where
        these are given."""
        alone = success if alone is None else alone
        contrasts = {effect_name(name): with_test(self.effect(*success[name])) for name in tested}
        for name in isolated(tested):
            if ends := self.together(alone[name], success[SHARED]):
                contrasts[change_name(name)] = with_test(change(*ends))
        return contrasts


def effect_name(condition: str) -> str:
    """Name the effect under a condition among the contrasts of a family."""
    return f"effect/{condition}"


def change_name(condition: str) -> str:
    """Name the change from an isolated condition to the shared one, likewise."""
    return f"change/{condition}"


def isolated(tested: Collection[str]) -> list[str]:
    """Return the conditions of a fault at one module, which the shared one is compared with."""
    if SHARED not in tested:
        return []
    return [condition for condition in tested if condition not in (CORRECT, SHARED)]


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
