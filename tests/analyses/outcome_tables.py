"""Outcome tables with known counts, and the record that follows."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import comb
from typing import Any

from outcomes import outcome, trial

from faultpath.analyses.decide import decide
from faultpath.analyses.facts import ComparisonFacts, SceneOrder
from faultpath.analyses.model import CORRECT, SHARED, AuditResult, Condition
from faultpath.faults import FaultText
from faultpath.run.findings import Deviation, Finding, Recheck, Unpaired
from faultpath.run.question import AuditQuestion
from faultpath.run.trials import Trial, Trials
from faultpath.system import Status

BASELINE, REPAIR = "old", "new"
_AGAIN = {"why": "sample", "unit": "", "variant": "old", "faults": "", "seed": 0, "unit_scenes": 9}
SPOILS: Mapping[str, Finding] = {
    "unrepeatable": Recheck(
        **_AGAIN, scenes=("s1",), deviation=Deviation(scenes=("s1",), of=1, ended=1)
    ),
    "unpaired": Unpaired(
        first=("new", "x"),
        second=("old", "x"),
        scene="s1",
        seed=0,
        differences=(("initial_hash", "a", "b"),),
    ),
}
"""Findings after which no result follows, by why none does."""
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
    taps = {name: () if name == CORRECT else (f"{name}.tap",) for name in names}
    return tuple(
        Condition(name=name, title=name, readers=readers, baseline_readers=())
        for name, readers in taps.items()
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
    altered: int | None = None,
) -> list[Trial]:
    """Return trials with these ends; the fault acts in the first `altered` of them, or in all."""
    faulted = condition != CORRECT
    acted = (len(statuses) if altered is None else altered) if variant == REPAIR and faulted else 0
    measured = {"terminal_distance_m": 1.0, "min_clearance_m": 0.25}
    return [
        trial(
            *(variant, condition, i, status),
            seed=seed,
            time_s=0.0 if status is Status.FAILED else 5.0 + 0.01 * i,
            metrics={} if status is Status.FAILED else measured,
            faulted_steps=3 * faulted,
            altered_steps=2 * (i < acted),
        )
        for i, status in enumerate(statuses)
    ]


def table(
    cells: Mapping[str, Counts | Sequence[Counts]], n: int = SCENES, **altered: int
) -> Trials:
    """Return trials with these counts, of one seed or seed by seed; `altered` as `rows` has it, by
    condition."""
    return Trials.of(
        row
        for condition, of in cells.items()
        for seed, counts in enumerate(of if isinstance(of, list) else [of])
        for variant, statuses in variants(counts, n).items()
        for row in rows(variant, condition, statuses, seed, altered.get(condition))
    )


def record(
    cells: Mapping[str, Counts | Sequence[Counts]],
    n: int = SCENES,
    altered: Mapping[str, int] = {},
    trained: bool = False,
    fails: Callable[[Trial], bool] = lambda row: False,
    **asked: object,
) -> AuditResult:
    """Return the record of such trials, of which some fail; `asked` changes the question."""
    first = next(iter(cells.values()))
    seeds = range(len(first)) if isinstance(first, list) else (0,)
    about, trials = facts(n, seeds, trained=trained), table(cells, n, **altered)
    ended = Trials.of(failed(row) if fails(row) else row for row in trials)
    return decide(question(**asked), about, conditions(*cells), ended)


def failed(row: Trial) -> Trial:
    return replace(row, outcome=outcome(row.scene_index, Status.FAILED, row.seed))


def three(correct: Counts, isolated: Counts, shared: Counts, **changes: object) -> AuditResult:
    return record({CORRECT: correct, "observer": isolated, SHARED: shared}, **changes)


def exact_p(wins: int, losses: int) -> float:
    """Return the two-sided exact binomial p-value of a split, by its definition."""
    n, k = wins + losses, min(wins, losses)
    if n == 0 or 2 * k == n:
        return 1.0
    return min(1.0, 2 * sum(comb(n, i) for i in range(k + 1)) / 2**n)
