"""What whole audits announce, by the rule of `faultpath audit` itself."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from faultpath.record.family import CORRECT, SHARED, Arms, decide_paths
from faultpath.selfcheck.model import Measured
from faultpath.selfcheck.populations import Population
from faultpath.statistics import IN_FORCE, Resamples
from faultpath.statistics.inputs import Floats
from faultpath.streams import generator

EQUAL, REVERSAL, TRAININGS = "equal arms", "no reversal", "trainings"
PATHS = (CORRECT, "reconstruction", "predictor", SHARED)
TRAINING_SD = 0.08
"""Standard deviation of the success of newly trained models of one method."""


@dataclass(frozen=True)
class EqualArms:
    """Audits with four paths of arms that do not differ: whatever is announced is false."""

    scenes: int
    population: Population
    together: float
    """Chance that a scene is the same on all paths, as where the fault changes nothing."""
    runs: int

    def measure(self) -> Measured:
        """Return the share of audits that announce anything: an effect, a change, a reversal."""
        stream = generator("selfcheck", repr(self), 0)
        paths: dict[str, Population] = dict.fromkeys(PATHS, self.population)
        announced = sum(
            decide_paths(
                audit_of(stream, self.scenes, paths, self.together), rule=IN_FORCE
            ).announces
            for _ in range(self.runs)
        )
        setting = {
            "scenes": self.scenes,
            "seeds": self.population.seeds,
            "rate": self.population.rate,
            "paths alike": self.together,
        }
        return Measured(EQUAL, setting, announced / self.runs, self.runs)


@dataclass(frozen=True)
class NoReversal:
    """Audits in which both isolated effects are ``isolated`` and the shared one is -20 pp."""

    scenes: int
    seeds: int
    isolated: float
    runs: int

    def measure(self) -> Measured:
        """Return the share of audits that announce a reversal."""
        stream = generator("selfcheck", repr(self), 0)
        lean = self.isolated / 0.3
        alone = Population(0.3, lean, self.seeds, 0.5)
        paths = {
            CORRECT: Population(0.1, 0.0, self.seeds, 0.5),
            "reconstruction": alone,
            "predictor": alone,
            SHARED: Population(0.3, -2.0 / 3.0, self.seeds, 0.5),
        }
        announced = 0
        for _ in range(self.runs):
            turns = decide_paths(audit_of(stream, self.scenes, paths, 0.3), rule=IN_FORCE).turns
            announced += "reversal" in turns.values()
        setting = {
            "scenes": self.scenes,
            "seeds": self.seeds,
            "isolated pp": round(100 * self.isolated, 1),
        }
        return Measured(REVERSAL, setting, announced / self.runs, self.runs)


@dataclass(frozen=True)
class Trainings:
    """Two methods that are equal, with 8 pp between one training and the next."""

    scenes: int
    seeds: int
    generalise: str
    runs: int

    def measure(self) -> Measured:
        """Return how often a difference is detected on the only path, `CORRECT`."""
        stream = generator("selfcheck", repr(self), 0)
        resamples = Resamples.draw("selfcheck", self.scenes, n_resamples=1)
        models = self.generalise == "models"
        detected = 0
        for _ in range(self.runs):
            shift = stream.normal(0.0, TRAINING_SD, size=self.seeds)
            easy = stream.random((self.scenes, 1))
            noise = stream.normal(0.0, 0.15, size=(2, self.scenes, self.seeds))
            arms = (easy + noise[0] < 0.5 + shift, easy + noise[1] < 0.5)
            family = decide_paths(
                {CORRECT: arms}, rule=IN_FORCE, resamples=resamples, models=models
            )
            detected += family.announces
        setting = {"scenes": self.scenes, "seeds": self.seeds, "generalise": self.generalise}
        return Measured(TRAININGS, setting, detected / self.runs, self.runs)


def equal_grid(runs: int) -> Iterator[EqualArms]:
    """Yield audits of equal arms."""
    sizes = ((3, 1), (25, 1), (100, 1), (25, 3), (100, 3))
    for (n, seeds), rate, together in product(sizes, (0.05, 0.3), (0.0, 0.7)):
        yield EqualArms(n, Population(rate, 0.0, seeds, 0.5), together, runs)


def reversal_grid(runs: int) -> Iterator[NoReversal]:
    """Yield audits without a reversal, and with one for comparison."""
    for n, seeds, isolated in product((25, 100), (1, 3), (0.0, 0.2)):
        yield NoReversal(n, seeds, isolated, runs)


def training_grid(runs: int) -> Iterator[Trainings]:
    """Yield audits of equal methods."""
    for generalise, seeds in product(("models", "scenes"), (2, 3, 5)):
        yield Trainings(100, seeds, generalise, runs)


def audit_of(
    stream: np.random.Generator, n: int, paths: Mapping[str, Population], together: float
) -> dict[str, Arms]:
    """Return paired successes [scenes, seeds] on each path."""
    seeds = next(iter(paths.values())).seeds
    common = stream.random((n, seeds + 2))
    found: dict[str, Arms] = {}
    for path, population in paths.items():
        same = stream.random((n, 1)) < together
        draws: Floats = np.where(same, common, stream.random((n, seeds + 2)))
        difference = population.outcomes(draws)
        found[path] = (difference >= 0.0, difference <= 0.0)
    return found
