"""Search for the platform whose baselines are the paper's, on the selection library.

    python tools/platform_search.py FOLDER --trials 60         search; the same again goes on
    python tools/platform_search.py FOLDER --finalists 3       the best ones with all three seeds
    python tools/platform_search.py FOLDER --show              the best so far

What is searched, what is matched and how is said in `docs/design/platform.md`. Nothing but
baselines is fitted or flown. `FOLDER/search.json` holds every trial and is written after every
step, so a run may be killed at any point; what was fitted and flown is kept beside it, by content.
It runs in one process on one thread, and needs Optuna (`tools/requirements-search.txt`).
"""

import argparse
import json
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import torch
from platform_judged import judged
from platform_matched import CELLS, QUANTITIES, ZERO, Flyer
from platform_space import SPACE, STARTS, platform_of

from faultpath.quadrotor import native
from faultpath.quadrotor.checkpoint import shipped_folder
from faultpath.quadrotor.platform import FIRST, Platform
from faultpath.quadrotor.training.collection import collect
from faultpath.quadrotor.training.fitting import fit
from faultpath.quadrotor.training.predictor_task import PredictorTask
from faultpath.quadrotor.training.provenance import code_of
from faultpath.store import atomic

RUNGS = (20, 50, 100)
"""Scenes of the rungs of successive halving, seed 0."""
KEEP = 3
"""One in so many of the trials that reached a rung goes on to the next."""
SEEDS = (0, 1, 2)
BY_SEED = ("WM-A, e = +0.1", "WM-A, e = -0.1", "zero wind, L3, free space")
"""Cells that the paper averages over seeds."""
MODELS = ("wm-a", "wm-a-wind")
WIND_EPISODES = 7150
"""As many as in still air: of the larger pool the mix would use no more windows."""
RANDOM_TRIALS = 12


class Search:
    """The record, and what stands beside it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.path = folder / "search.json"
        self.code = code_of("training.closed_loop", "training.predictor_task", "training.shards")
        for each in ("models", "flights"):
            (folder / each).mkdir(parents=True, exist_ok=True)
        self.record = self._opened()

    def save(self) -> None:
        """Write the record whole."""
        atomic.write(self.path, (json.dumps(self.record, indent=1) + "\n").encode())

    def measure(self, platform: Platform, scenes: int, seeds: Sequence[int]) -> dict[str, Any]:
        """Return the quantities of a platform on so many scenes, fitting and flying what lacks.

        The lowest rung has no wind: the model that is told of it takes four times as long to fit.
        """
        cells = [cell for cell in CELLS if scenes > RUNGS[0] or CELLS[cell].variant != ZERO]
        names = MODELS if scenes > RUNGS[0] else MODELS[:1]
        models = self._models(platform, names, seeds)
        flyer = Flyer(platform, models, self.folder / "flights", self.code)
        bounds = (0, *(rung for rung in RUNGS if rung <= scenes))
        flown = {
            cell: [
                flyer.block(cell, seed, first, last)
                for seed in (seeds if cell in BY_SEED else seeds[:1])
                for first, last in pairwise(bounds)
            ]
            for cell in cells
        }
        return judged(flown)

    def _models(self, platform: Platform, names: Sequence[str], seeds: Sequence[int]) -> Path:
        """Return the folder of the fitted baselines; platforms with the same data share it."""
        if platform == FIRST:
            return shipped_folder()
        folder = self.folder / "models" / f"{platform.weights_hash('wm-a')}-{self.code[:12]}"
        data = folder / "data"
        missing = [
            (name, seed)
            for name in names
            for seed in seeds
            if not (folder / f"{name}-{seed}.json").exists()
        ]
        if missing:
            folder.mkdir(exist_ok=True)
            for file in shipped_folder().glob("clearance-0.*"):
                shutil.copy(file, folder)
            pools = ("nominal", "wind") if MODELS[1] in dict(missing) else ("nominal",)
            collect(data, pools, 0, {"wind": WIND_EPISODES}, platform=platform)
        for name, seed in missing:
            with native.using(native.PORTABLE):  # as every fit
                fit(PredictorTask(name, seed, data, platform=platform), folder)
        shutil.rmtree(data, ignore_errors=True)
        return folder

    def _opened(self) -> dict[str, Any]:
        if self.path.exists():
            found = json.loads(self.path.read_text("utf-8"))
            if found["code"] != self.code:
                raise SystemExit(
                    f"{self.path} is a search with other code than this: go on from the checkout "
                    f"of commit {found['commit']}, or give another folder."
                )
            return found
        return {
            "commit": _commit(),
            "code": self.code,
            "rungs": list(RUNGS),
            "keep": KEEP,
            "space": SPACE,
            "matched": [
                {"group": q.group, "name": q.name, "kind": q.kind, "target": q.target}
                for q in QUANTITIES
            ],
            "trials": [],
        }


def search(found: Search, trials: int) -> None:
    """Evaluate until there are so many trials, beginning with the one that was cut short."""
    made = found.record["trials"]
    while True:
        todo = next((each for each in made if each["state"] == "running"), None)
        if todo is None:
            if len(made) >= trials:
                return
            todo = _asked(found)
            made.append(todo)
            found.save()
        started = time.monotonic()
        climb(found, todo, platform_of(todo["point"]))
        todo["seconds"] = round(todo.get("seconds", 0.0) + time.monotonic() - started)
        found.save()
        print(line(todo), flush=True)


def climb(found: Search, trial: dict[str, Any], platform: Platform) -> None:
    """Take a trial up the rungs until it is not among the best of one."""
    trial["platform"] = platform.hash
    for scenes in RUNGS:
        if all(rung["scenes"] != scenes for rung in trial["rungs"]):
            measured = found.measure(platform, scenes, SEEDS[:1])
            trial["rungs"].append({"scenes": scenes, **measured})
            found.save()
        if scenes != RUNGS[-1] and not _promoted(found.record["trials"], trial, scenes):
            trial["state"] = "pruned"
            return
    trial["state"] = "complete"


def finals(found: Search, count: int) -> None:
    """Measure the best complete trials with all seeds, and the first platform beside them."""
    done = [each for each in found.record["trials"] if each["state"] == "complete"]
    for trial in sorted(done, key=distance)[:count]:
        if "final" not in trial:
            trial["final"] = found.measure(platform_of(trial["point"]), RUNGS[-1], SEEDS)
            found.save()
        print(line(trial), "all seeds:", trial["final"]["distance"], flush=True)
    if "first" not in found.record:
        found.record["first"] = found.measure(FIRST, RUNGS[-1], SEEDS)
        found.save()
    print("the first platform:", found.record["first"]["distance"], flush=True)


def distance(trial: dict[str, Any]) -> float:
    """Return the distance at the highest rung of a trial."""
    return trial["rungs"][-1]["distance"]


def line(trial: dict[str, Any]) -> str:
    """Return a trial in a line."""
    rungs = ", ".join(f"{each['scenes']}: {each['distance']}" for each in trial["rungs"])
    return f"{trial['number']} {trial['state']} [{rungs}] {json.dumps(trial['point'])}"


def _promoted(trials: list[dict[str, Any]], trial: dict[str, Any], scenes: int) -> bool:
    reached = sorted(
        rung["distance"] for each in trials for rung in each["rungs"] if rung["scenes"] == scenes
    )
    mine = next(rung["distance"] for rung in trial["rungs"] if rung["scenes"] == scenes)
    return reached.index(mine) < -(-len(reached) // KEEP)


def _asked(found: Search) -> dict[str, Any]:
    """Return the next trial: what the sampler makes of all former ones.

    The sampler is made anew for each, with the number as its seed, so that a search that was cut
    short goes on as it would have gone.
    """
    trials = found.record["trials"]
    number = len(trials)
    point = STARTS[number] if number < len(STARTS) else None
    if point is None:
        import optuna  # only here: what was found can be shown without it

        optuna.logging.set_verbosity(optuna.logging.WARNING)
        sampler = optuna.samplers.TPESampler(
            seed=number, multivariate=True, n_startup_trials=RANDOM_TRIALS
        )
        study = optuna.create_study(sampler=sampler)
        study.add_trials([_told(each) for each in trials])
        point = study.ask(_distributions()).params
    return {"number": number, "point": point, "state": "running", "rungs": []}


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
    parser.add_argument("--finalists", type=int, default=0, help="best ones to fly with all seeds")
    parser.add_argument("--show", action="store_true", help="print the best trials")
    asked = parser.parse_args()
    torch.set_num_threads(1)
    found = Search(asked.folder)
    steps = {
        asked.trials: partial(search, found, asked.trials),
        asked.finalists: partial(finals, found, asked.finalists),
    }
    for wanted, step in steps.items():
        if wanted:
            step()
    if asked.show:
        measured = [each for each in found.record["trials"] if each["rungs"]]
        for trial in sorted(measured, key=lambda t: (-t["rungs"][-1]["scenes"], distance(t)))[:15]:
            print(line(trial))
    return 0


if __name__ == "__main__":
    sys.exit(main())
