"""A system without a loop whose errors do what a test plants, and the scan of it in memory.

Scenes have a difficulty, evenly spread over 0 to 1; a trial succeeds where that is above what the
errors cost together. `a`, `b` and `c` have one reader each, `pair` two, `three` three.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from still import Still

from faultpath.analyses.scan.analysis import ScanAnalysis, Scanned, scan_analysis
from faultpath.analyses.scan.model import ScanResult
from faultpath.interface import Interface
from faultpath.run.deliveries import Deliveries
from faultpath.run.plan import Plan, SystemSpec
from faultpath.run.question import ScanQuestion, ask
from faultpath.run.trials import Trial, Trials
from faultpath.system import Variant
from faultpath.system.outcome import Outcome, Status, failed_outcome

READERS = {
    "a": ("one.a",),
    "b": ("two.b",),
    "c": ("two.c",),
    "pair": ("one.pair", "two.pair"),
    "three": ("one.three", "two.three", "last.three"),
}
Cost = Callable[[Mapping[str, float]], float]
"""What errors cost, by reader, such as `one.pair`."""


class Planted(Still):
    name, named = "planted", "s{:04d}"

    def __init__(
        self,
        cost: Cost,
        sources: Sequence[str] = ("a", "b"),
        scenes: int = 400,
        std: float | None = 0.4,
    ) -> None:
        self.cost, self.scenes = cost, scenes
        self.failing: set[tuple[str, str]] = set()
        self.unlike: set[tuple[str, str]] = set()
        """Condition and scene of trials that fail, and of those that begin elsewhere."""
        unsure = {"uncertainty": std and {"std": std}, "unit": "m", "provenance": "estimated"}
        facts = {
            "name": "planted",
            "sources": [{"name": name, **unsure} for name in sources],
            "channels": [{"name": n, "sources": [n], "readers": READERS[n]} for n in sources],
        }
        self.interface = Interface.model_validate(facts)
        readers = frozenset(reader for name in sources for reader in READERS[name])
        self.variants = {name: Variant(name, "", readers) for name in ("whole", "deaf")}


def difficulty(scene: str) -> float:
    """Return that of a scene, evenly spread in any row of scenes."""
    return (int(scene[1:]) * 0.6180339887498949) % 1.0


def trials_of(system: Planted, plan: Plan) -> Trials:
    """Return the trials of a plan, each from what its faults cost; `deaf` reads no error."""
    trials: list[Trial] = []
    for row in plan.rows:
        at = {
            reader: float(fault.intervention.by)  # pyright: ignore - an offset
            for fault in row.treatment.faults
            for reader in fault.readers
        }
        cost = system.cost(at if row.variant == "whole" else {})
        for scene in row.scenes:
            status = Status.SUCCESS if difficulty(scene) >= cost else Status.TIMEOUT
            acted = int(bool(at) and row.variant == "whole")
            hashes = (scene, scene, "none")
            outcome = Outcome(scene, status, 1.0, *hashes, faulted_steps=acted, altered_steps=acted)
            if (row.condition, scene) in system.failing:
                outcome = failed_outcome(scene, "no air")
            elif (row.condition, scene) in system.unlike:
                outcome = replace(outcome, initial_hash="another")
            trials.append(Trial(row.variant, row.condition, row.seed, int(scene[1:]), "", outcome))
    return Trials.of(trials)


def planned(system: Planted, **arguments: Any) -> ScanAnalysis:
    question = ask(ScanQuestion, {"variant": "whole", **arguments})
    return scan_analysis(system, SystemSpec(name="planted"), question, system.library("selection"))


def scanned(system: Planted, **arguments: Any) -> tuple[ScanResult, Scanned, list[Plan]]:
    """Run the rounds of a scan; return its result, what ran, and the plan of each round."""
    analysis = planned(system, **arguments)
    rounds = analysis.rounds()
    plans = [next(rounds).plan]
    while True:
        trials = trials_of(system, plans[-1])
        try:
            plans.append(rounds.send(trials).plan)
        except StopIteration as end:
            return analysis.conclude(trials, Deliveries(rows=()), end.value), end.value, plans


def names(record: ScanResult, places: Sequence[int]) -> set[str]:
    """Return errors by source, reader and sign: `a+one`."""
    errors = [record.errors[place] for place in places]
    return {f"{e.source}{'+' if e.sign > 0 else '-'}{e.reader}" for e in errors}
