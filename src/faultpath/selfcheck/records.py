"""What whole records announce of arms that do not differ: lopsided ones, those of which trials die,
and audits that are extended after a look. Tables are decided as `faultpath audit` decides them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from faultpath.record import CORRECT, SHARED, DecisionRecord, Path, Question, decide
from faultpath.record.family import decide_paths
from faultpath.record.looks import after_looks
from faultpath.selfcheck.model import Measured
from faultpath.statistics import IN_FORCE
from faultpath.streams import generator
from faultpath.trials import Outcome, OutcomeTable, Status, TrialRow

LOPSIDED, DYING, EXTENDED = "lopsided arms", "dying trials", "extended audits"
_PATHS = (CORRECT, "first", "second", SHARED)
_HARD = 0.4
"""Share of scenes in which an arm fails."""
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Lopsided:
    """Arms of one mean: in a share ``gains`` of the scenes the first wins one seed, in few it loses
    all of them."""

    scenes: int
    seeds: int
    gains: float
    runs: int

    def measure(self) -> Measured:
        """Return the share of audits that announce anything."""
        stream = generator("selfcheck", repr(self), 0)
        announced = 0
        for _ in range(self.runs):
            arms = {path: self._arms(stream) for path in _PATHS}
            announced += decide_paths(arms, rule=IN_FORCE).announces
        setting = {"scenes": self.scenes, "seeds": self.seeds, "gains": self.gains}
        return Measured(LOPSIDED, setting, announced / self.runs, self.runs)

    def _arms(self, stream: np.random.Generator) -> tuple[Bools, Bools]:
        kind = stream.random((self.scenes, 1))
        which = stream.integers(0, self.seeds, size=(self.scenes, 1))
        gained = (kind < self.gains) & (np.arange(self.seeds) == which)
        lost = (kind > 1.0 - self.gains / self.seeds) & np.ones(self.seeds, dtype=np.bool_)
        return ~lost, ~gained


@dataclass(frozen=True)
class Dying:
    """Equal arms, of which the repair raises an error in a share of its failures under `SHARED`."""

    scenes: int
    share: float
    runs: int

    def measure(self) -> Measured:
        """Return the share of records that decide for either arm, on any path."""
        stream = generator("selfcheck", repr(self), 0)
        announced = 0
        for _ in range(self.runs):
            arms = _equal(stream, self.scenes)
            died = {SHARED: stream.random(self.scenes) < self.share}
            announced += _announces(concluded(arms, self.scenes, died))
        setting = {"scenes": self.scenes, "share": self.share}
        return Measured(DYING, setting, announced / self.runs, self.runs)


@dataclass(frozen=True)
class Extended:
    """Equal arms, concluded with some scenes, and with more where that announced nothing."""

    scenes: tuple[int, ...]
    runs: int

    def measure(self) -> tuple[Measured, ...]:
        """Return the share that announces anything in the end, and that which does not say that it
        was concluded before."""
        stream = generator("selfcheck", repr(self), 0)
        announced = {"with or without": 0, "without": 0}
        for _ in range(self.runs):
            arms = _equal(stream, max(self.scenes))
            record = None
            for scenes in self.scenes:
                made = concluded(arms, scenes)
                record = made if record is None else after_looks(made, [record])
                if _announces(record):
                    announced["with or without"] += 1
                    announced["without"] += not record.earlier
                    break
        scenes = ", ".join(map(str, self.scenes))
        return tuple(
            Measured(EXTENDED, {"scenes": scenes, "finding": finding}, count / self.runs, self.runs)
            for finding, count in announced.items()
        )


def _equal(stream: np.random.Generator, scenes: int) -> dict[str, tuple[Bools, Bools]]:
    easy = stream.random(scenes)
    noise = stream.normal(0.0, 0.25, size=(len(_PATHS), 2, scenes))
    ends = easy + noise > _HARD
    return {path: (one, two) for path, (one, two) in zip(_PATHS, ends, strict=True)}


def _announces(record: DecisionRecord) -> bool:
    return any(each.sign for each in (*record.effects, *record.changes))


def concluded(
    arms: Mapping[str, tuple[Bools, Bools]], scenes: int, died: Mapping[str, Bools] | None = None
) -> DecisionRecord:
    """Return the record of the first ``scenes``; the repair ``died`` where it failed and that says
    so."""
    rows: list[TrialRow] = []
    for path, (repair, baseline) in arms.items():
        dead = (died or {}).get(path, np.zeros_like(repair)) & ~repair
        for variant, success, failed in (
            ("repair", repair, dead),
            ("baseline", baseline, np.zeros_like(dead)),
        ):
            rows += [
                TrialRow(
                    variant=variant,
                    path=path,
                    seed=0,
                    scene_index=scene,
                    topology="",
                    outcome=_outcome(scene, path, bool(success[scene]), bool(failed[scene])),
                )
                for scene in range(scenes)
            ]
    asked = Question(
        system="simulated",
        options={},
        baseline="baseline",
        repair="repair",
        fault="simulated",
        library="simulated",
        library_hash="simulated",
        n_scenes=scenes,
        seeds=(0,),
        metrics={},
        rule=IN_FORCE,
    )
    paths = [
        Path(
            name=path,
            title=path,
            consumers=() if path == CORRECT else (path,),
            baseline_consumers=() if path == CORRECT else (path,),
        )
        for path in arms
    ]
    return decide(asked, paths, OutcomeTable(tuple(rows)))


def _outcome(scene: int, path: str, success: bool, failed: bool) -> Outcome:
    ended = Status.SUCCESS if success else Status.CRASH
    acted = int(path != CORRECT)
    return Outcome(
        scene=f"{scene:04d}",
        status=Status.FAILED if failed else ended,
        time_s=0.0 if failed else 1.0,
        error="died" if failed else None,
        initial_hash=f"{scene}",
        disturbance_hash=f"{scene}",
        planner_noise_hash=f"{scene}",
        struck_steps=acted,
        altered_steps=acted,
    )


def lopsided_grid(runs: int) -> Iterator[Lopsided]:
    """Yield lopsided arms."""
    for n, seeds, gains in product((25, 100), (3, 5), (0.15, 0.3, 0.6)):
        yield Lopsided(n, seeds, gains, runs)


def record_grid(runs: int) -> Iterator[Dying | Extended]:
    """Yield arms of which trials die, and audits that are extended."""
    for share in (0.5, 1.0):
        yield Dying(50, share, runs)
    yield Extended((25, 50, 75, 100), runs)
