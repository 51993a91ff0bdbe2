"""Search for the platform whose baselines are the paper's, on the selection library.

    python tools/platform_search.py FOLDER --trials 60         search; the same again goes on
    python tools/platform_search.py FOLDER --finalists 3       the best ones with all three seeds
    python tools/platform_search.py FOLDER --show              the best so far

What is searched, what is matched and how is said in `docs/design/platform.md`. Nothing but
baselines is fitted or flown. `FOLDER/search.json` holds every trial and is written after every
step, so a run may be killed at any point; what was fitted and flown is kept beside it, by content.
Proposals need Optuna (`tools/requirements-search.txt`).
"""

import argparse
import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from platform_matched import QUANTITIES
from platform_measured import RUNGS, SEEDS, Measurer
from platform_space import SPACE, STARTS, platform_of

from faultpath.quadrotor.platform import Platform
from faultpath.quadrotor.platforms import FIRST
from faultpath.quadrotor.training.provenance import code_of
from faultpath.store import atomic
from faultpath.work import Executor, local, run_all

KEEP = 3
"""One in so many of the trials that reached a rung goes on to the next."""
GENERATION = 12
"""Trials that are proposed together; the first generation is random, but for the starts."""


class Search:
    """The record, and who measures for it."""

    def __init__(self, folder: Path, executor: Executor) -> None:
        self.path = folder / "search.json"
        code = code_of("training.closed_loop", "training.predictor_task", "training.shards")
        folder.mkdir(parents=True, exist_ok=True)
        self.record = self._opened(code)
        self._measurer = Measurer(folder.resolve(), code)
        self._executor = executor

    def save(self) -> None:
        """Write the record whole."""
        atomic.write(self.path, (json.dumps(self.record, indent=1) + "\n").encode())

    def measured(
        self, platforms: Sequence[Platform], rung: int, seeds: Sequence[int]
    ) -> Iterator[tuple[int, dict[str, Any]]]:
        """Yield what was measured of each platform with its place, as they end."""
        calls = [partial(self._measurer.measure, each, rung, seeds) for each in platforms]
        return run_all(self._executor, calls)

    def _opened(self, code: str) -> dict[str, Any]:
        if self.path.exists():
            found = json.loads(self.path.read_text("utf-8"))
            if found["code"] != code:
                raise SystemExit(
                    f"{self.path} is a search with other code than this: go on from the checkout "
                    f"of commit {found['commit']}, or give another folder."
                )
            return found
        return {
            "commit": _commit(),
            "code": code,
            "rungs": [{"scenes": rung.scenes, "fitted": rung.fitted} for rung in RUNGS],
            "keep": KEEP,
            "generation": GENERATION,
            "space": SPACE,
            "matched": [
                {"group": q.group, "name": q.name, "kind": q.kind, "target": q.target}
                for q in QUANTITIES
            ],
            "trials": [],
        }


def search(found: Search, trials: int, by_hand: Sequence[dict[str, Any]] = ()) -> None:
    """Evaluate generations until there are so many trials; what is given by hand goes first."""
    made = found.record["trials"]
    while True:
        running = [each for each in made if each["state"] == "running"]
        if running:
            climb(found, running)
        elif len(made) < trials:
            made += _asked(made, min(GENERATION, trials - len(made)), by_hand)
            by_hand = ()
            found.save()
        else:
            return


def climb(found: Search, generation: list[dict[str, Any]]) -> None:
    """Take the trials of a generation up the rungs, those that are among the best of each."""
    for rung in range(len(RUNGS)):
        waiting = [trial for trial in generation if len(trial["rungs"]) == rung]
        platforms = [platform_of(trial["point"]) for trial in waiting]
        for place, measured in found.measured(platforms, rung, SEEDS[:1]):
            waiting[place]["rungs"].append({"scenes": RUNGS[rung].scenes, **measured})
            found.save()
            print(line(waiting[place]), flush=True)
        for trial in generation:
            if rung + 1 == len(RUNGS):
                trial["state"] = "complete"
            elif not _promoted(found.record["trials"], trial, rung):
                trial["state"] = "pruned"
        generation = [trial for trial in generation if trial["state"] == "running"]
        found.save()


def finals(found: Search, count: int) -> None:
    """Measure the best complete trials with all seeds, and the first platform beside them."""
    done = [each for each in found.record["trials"] if each["state"] == "complete"]
    best = [trial for trial in sorted(done, key=distance)[:count] if "final" not in trial]
    platforms = [platform_of(trial["point"]) for trial in best]
    if "first" not in found.record:
        platforms.append(FIRST)
    for place, measured in found.measured(platforms, len(RUNGS) - 1, SEEDS):
        if place < len(best):
            best[place]["final"] = measured
            print(line(best[place]), "all seeds:", measured["distance"], flush=True)
        else:
            found.record["first"] = measured
            print("the first platform:", measured["distance"], flush=True)
        found.save()


def distance(trial: dict[str, Any]) -> float:
    """Return the distance at the highest rung of a trial."""
    return trial["rungs"][-1]["distance"]


def line(trial: dict[str, Any]) -> str:
    """Return a trial in a line."""
    rungs = ", ".join(f"{each['scenes']}: {each['distance']}" for each in trial["rungs"])
    return f"{trial['number']} {trial['state']} [{rungs}] {json.dumps(trial['point'])}"


def _promoted(trials: list[dict[str, Any]], trial: dict[str, Any], rung: int) -> bool:
    reached = sorted(
        each["rungs"][rung]["distance"] for each in trials if len(each["rungs"]) > rung
    )
    return reached.index(trial["rungs"][rung]["distance"]) < -(-len(reached) // KEEP)


def _asked(
    trials: list[dict[str, Any]], count: int, by_hand: Sequence[dict[str, Any]]
) -> list[dict[str, Any]]:
    numbers = range(len(trials), len(trials) + count)
    starts = [{"point": point} for point in STARTS[len(trials) :]]
    given = [*starts, *({"by_hand": True, "point": point} for point in by_hand)][:count]
    lacking = count - len(given)
    proposed = [{"point": point} for point in _proposed(trials, lacking)] if lacking else []
    return [
        {"number": number, **each, "state": "running", "rungs": []}
        for number, each in zip(numbers, [*given, *proposed], strict=True)
    ]


def _proposed(trials: list[dict[str, Any]], count: int) -> list[dict[str, Any]]:
    """Return what the sampler makes of all former trials.

    It is made anew, with their number as its seed, so that a search that was cut short goes on as
    it would have gone.
    """
    import optuna  # only here: what was found can be shown without it

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    sampler = optuna.samplers.TPESampler(
        seed=len(trials), multivariate=True, constant_liar=True, n_startup_trials=GENERATION
    )
    study = optuna.create_study(sampler=sampler)
    study.add_trials([_told(each) for each in trials])
    return [study.ask(_distributions()).params for _ in range(count)]


def _told(trial: dict[str, Any]) -> Any:
    from optuna.trial import TrialState, create_trial

    complete = trial["state"] == "complete"
    return create_trial(
        state=TrialState.COMPLETE if complete else TrialState.PRUNED,
        value=distance(trial) if complete else None,
        params=trial["point"],
        distributions=_distributions(),
        intermediate_values={rung["scenes"]: rung["distance"] for rung in trial["rungs"]},
    )


def _distributions() -> dict[str, Any]:
    from optuna.distributions import CategoricalDistribution, FloatDistribution

    return {
        name: (CategoricalDistribution if "choices" in given else FloatDistribution)(**given)
        for name, given in SPACE.items()
    }


def _commit() -> str:
    asked = ("git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty")
    return subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()


def main() -> int:
    """Search; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--trials", type=int, default=0, help="trials that there will be in all")
    parser.add_argument("--by-hand", type=Path, help="JSON list of points to try first")
    parser.add_argument("--finalists", type=int, default=0, help="best ones to fly with all seeds")
    parser.add_argument("--workers", type=int, default=2, help="processes of one thread each")
    parser.add_argument("--show", action="store_true", help="print the best trials")
    asked = parser.parse_args()
    with local(asked.workers) as executor:
        found = Search(asked.folder, executor)
        if asked.trials:
            points = json.loads(asked.by_hand.read_text("utf-8")) if asked.by_hand else ()
            search(found, asked.trials, points)
        if asked.finalists:
            finals(found, asked.finalists)
    if asked.show:
        measured = [each for each in found.record["trials"] if each["rungs"]]
        for trial in sorted(measured, key=lambda t: (-t["rungs"][-1]["scenes"], distance(t)))[:15]:
            print(line(trial))
    return 0


if __name__ == "__main__":
    sys.exit(main())
