"""Success of two variants under each condition, pair by pair, and trials without an outcome."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from faultpath.analyses.model import where
from faultpath.core.errors import UserError
from faultpath.run.findings import Unpaired
from faultpath.run.pairing import Group, Pairs, pair
from faultpath.run.trials import Bools, Trials
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
    void: tuple[str, ...]
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
    unpaired = tuple(found for paired in pairs.values() for found in paired.unpaired)
    success = {condition: paired.success for condition, paired in pairs.items()}
    left = [condition for condition, pair in success.items() if paired_scenes(*pair).any()]
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
        void=tuple(condition for condition in pairs if condition not in left),
        unpaired=unpaired,
    )


def paired_scenes(repair: Floats, baseline: Floats) -> Bools:
    """Return `[scenes]` whether any seed has both outcomes."""
    return np.asarray(~np.isnan(repair - baseline).all(axis=1), dtype=np.bool_)
