"""What an audit may announce, decided together: one function, from outcomes to decisions."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faultpath.record.model import Extreme, Turn
from faultpath.statistics import (
    Comparison,
    Decision,
    Resamples,
    compare,
    decide_family,
    difference_of_effects,
    fewest_scenes,
    success_effect,
    turn,
)
from faultpath.statistics import Effect as Draws

CORRECT = "correct"
SHARED = "shared"
ALPHA = 0.05
FLOOR_PERCENT, CEILING_PERCENT = 10.0, 90.0

Bools = NDArray[np.bool_]
Arms = tuple[Bools, Bools]
"""Success of the repair and of the baseline, each `[scenes, seeds]`."""


@dataclass(frozen=True)
class Decided:
    """One contrast of the family: its numbers, and what the whole family makes of it."""

    effect: Draws
    comparison: Comparison
    decision: Decision | None
    """`None` where it is not in the family, because nothing was tested."""

    @property
    def sign(self) -> int:
        """Side that is decided; 0 for neither."""
        return self.decision.sign if self.decision else 0


@dataclass(frozen=True)
class Family:
    """Every contrast of an audit with its decision."""

    effects: Mapping[str, Decided]
    """By path."""
    changes: Mapping[str, Decided]
    """Shared minus isolated, by the isolated path."""
    turns: Mapping[str, Turn]
    extremes: Mapping[str, Extreme | None]
    """By path: where both arms are at the floor or at the ceiling."""
    hypotheses: int
    scenes_needed: int

    @property
    def announces(self) -> bool:
        """Whether anything is detected: an effect, a change, a reversal."""
        return any(each.sign for part in (self.effects, self.changes) for each in part.values())


def decide_paths(
    success: Mapping[str, Arms],
    *,
    resamples: Resamples | None = None,
    models: bool = False,
    untested: Collection[str] = (),
    alpha: float = ALPHA,
) -> Family:
    """Return what is decided of all paths, from paired successes `[scenes, seeds]` alone.

    This is the rule of `faultpath audit`, without words and without secondary outcomes, and what
    simulations of its error rates call. The family holds the effect on every path and every change
    from an isolated path to `SHARED`; Holm's procedure runs over all of them at `alpha`. Paths in
    `untested` (the fault never acted there) take no part. `models` speaks of newly trained models
    as well. `resamples` are drawn where they are not given.
    """
    n_scenes = len(next(iter(success.values()))[0])
    # Only what speaks of newly trained models resamples.
    drawn = resamples or Resamples.draw("family", n_scenes, n_resamples=10_000 if models else 1)
    effects = {
        path: success_effect(repair, baseline, drawn, resample_seeds=models)
        for path, (repair, baseline) in success.items()
    }
    changes = {
        path: difference_of_effects(effects[path], effects[SHARED])
        for path in _isolated([path for path in effects if path not in untested])
    }
    compared = {path: compare(effect) for path, effect in effects.items()}
    changed = {path: compare(effect) for path, effect in changes.items()}
    family = {("effect", path): c for path, c in compared.items() if path not in untested}
    family |= {("change", path): c for path, c in changed.items()}
    made = decide_family({"/".join(key): c for key, c in family.items()}, alpha)
    return Family(
        effects={
            path: Decided(effect, compared[path], made.get(f"effect/{path}"))
            for path, effect in effects.items()
        },
        changes={
            path: Decided(effect, changed[path], made[f"change/{path}"])
            for path, effect in changes.items()
        },
        turns={
            path: turn(made[f"effect/{path}"], made[f"effect/{SHARED}"], made[f"change/{path}"])
            for path in changes
        },
        extremes={path: _extreme(*arms) for path, arms in success.items()},
        hypotheses=len(family),
        scenes_needed=fewest_scenes(len(family), alpha),
    )


def _isolated(tested: Collection[str]) -> list[str]:
    """Return the paths that the shared one is compared with."""
    return [path for path in tested if path not in (CORRECT, SHARED)] if SHARED in tested else []


def percent(success: Bools) -> float:
    """Return success in percent."""
    return 100.0 * float(success.sum()) / success.size


def _extreme(repair: Bools, baseline: Bools) -> Extreme | None:
    rates = percent(repair), percent(baseline)
    if max(rates) < FLOOR_PERCENT:
        return "floor"
    return "ceiling" if min(rates) > CEILING_PERCENT else None
