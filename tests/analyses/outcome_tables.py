"""Outcome tables with known counts, and the record that follows."""

from collections.abc import Mapping, Sequence
from math import comb
from typing import Any

from faultpath.analyses.decide import decide
from faultpath.analyses.facts import ComparisonFacts, SceneOrder
from faultpath.analyses.model import CORRECT, SHARED, Condition
from faultpath.analyses.record import DecisionRecord
from faultpath.faults import FaultText
from faultpath.run import Trial, Trials
from faultpath.run.question import AuditQuestion
from faultpath.system import Outcome, Status

BASELINE, REPAIR = "old", "new"
SCENES = 100
MOST_WORDS = 24
"""Most words of a headline; names of modules and variants are one word each."""

Counts = tuple[int, int, int]
"""Scenes that both win, that only the repair wins, and that only the baseline wins."""


def question(**asked: Any) -> AuditQuestion:
    fault = FaultText.read("gain:scale=0.6")
    return AuditQuestion(baseline=BASELINE, repair=REPAIR, fault=fault, **asked)


def facts(n_scenes: int = SCENES, seeds: Sequence[int] = (0,), **more: Any) -> ComparisonFacts:
    return ComparisonFacts(
        system="toy",
        library="made up",
        library_hash="hash-1",
        n_scenes=n_scenes,
        seeds=tuple(seeds),
        **more,
    )


def sequential(per_analysis: int = 5) -> SceneOrder:
    return SceneOrder(scenes=(), seed=0, per_analysis=per_analysis, trials=8)


def conditions(*names: str) -> tuple[Condition, ...]:
    return tuple(
        Condition(
            name=name,
            title=name,
            readers=() if name == CORRECT else (f"{name}.tap",),
            baseline_readers=(),
        )
        for name in names
    )


def variants(counts: Counts, n: int = SCENES) -> dict[str, list[Status]]:
    """Return the repair's and the baseline's trials with these counts, the rest lost by both."""
    both, wins, losses = counts
    lost = n - both - wins - losses
    assert lost >= 0
    yes, no = Status.SUCCESS, Status.CRASH
    return {
        REPAIR: [yes] * (both + wins) + [no] * (losses + lost),
        BASELINE: [yes] * both + [no] * wins + [yes] * losses + [no] * lost,
    }


def rows(
    variant: str,
    condition: str,
    statuses: Sequence[Status],
    seed: int = 0,
    slower_s: float = 0.0,
    altered: int | None = None,
) -> list[Trial]:
    """Return trials with these ends; the fault acts in the first `altered` of them, or in all."""
    return [
        Trial(
            variant=variant,
            condition=condition,
            seed=seed,
            scene_index=i,
            topology="",
            outcome=Outcome(
                scene=f"s{i:03d}",
                status=status,
                time_s=0.0 if status is Status.FAILED else 5.0 + 0.01 * i + slower_s,
                metrics={}
                if status is Status.FAILED
                else {"terminal_distance_m": 1.0 + slower_s, "min_clearance_m": 0.25},
                initial_hash=f"i{i}",
                disturbance_hash=f"d{i}",
                planner_noise_hash=f"n{i}-{seed}",
                faulted_steps=3 if condition != CORRECT else 0,
                altered_steps=2
                if condition != CORRECT
                and variant == REPAIR
                and i < (len(statuses) if altered is None else altered)
                else 0,
            ),
        )
        for i, status in enumerate(statuses)
    ]


def table(cells: Mapping[str, Counts], n: int = SCENES, slower_s: float = 0.0) -> Trials:
    out: list[Trial] = []
    for condition, counts in cells.items():
        for variant, statuses in variants(counts, n).items():
            late = slower_s if variant == REPAIR else 0.0
            out += rows(variant, condition, statuses, slower_s=late)
    return Trials.of(out)


def record(cells: Mapping[str, Counts], n: int = SCENES, **changes: float) -> DecisionRecord:
    return decide(question(), facts(n), conditions(*cells), table(cells, n, **changes))


def seeded(
    cells: Mapping[str, Sequence[Counts]], n: int = SCENES, trained: bool = False, **asked: object
) -> DecisionRecord:
    """Return the record of several seeds, counts seed by seed; `asked` changes the question."""
    out = [
        row
        for condition, by_seed in cells.items()
        for seed, counts in enumerate(by_seed)
        for variant, statuses in variants(counts, n).items()
        for row in rows(variant, condition, statuses, seed=seed)
    ]
    seeds = range(len(next(iter(cells.values()))))
    about = facts(n, tuple(seeds), trained=trained)
    return decide(question(**asked), about, conditions(*cells), Trials.of(out))


def three(correct: Counts, isolated: Counts, shared: Counts) -> DecisionRecord:
    return record({CORRECT: correct, "observer": isolated, SHARED: shared})


def exact_p(wins: int, losses: int) -> float:
    """Return the two-sided exact binomial p-value of a split, by its definition."""
    n, k = wins + losses, min(wins, losses)
    if n == 0 or 2 * k == n:
        return 1.0
    return min(1.0, 2 * sum(comb(n, i) for i in range(k + 1)) / 2**n)
