"""An environment that ends each episode in its own time, and a module that moves it."""

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Dict, Discrete

from faultpath.loop import Module, Port
from faultpath.run.attempt import taps_of
from faultpath.run.plan import Treatment
from faultpath.system import ComposedSystem
from faultpath.system.gymnasium import GymnasiumPlant

REAL = Box(-np.inf, np.inf, (1,), np.float64)
SCENES = tuple(f"seed/{i}" for i in range(6))


class Walk(gymnasium.Env):
    """A walker that falls off beyond 3, and is called back after some steps of its own number."""

    observation_space = Box(-np.inf, np.inf, (2,), np.float64)
    action_space = Box(-1.0, 1.0, (1,), np.float64)
    dt = 0.5

    def __init__(self):
        self.slope, self.calls = 0.0, []

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.at, self.step_count = float(self.np_random.uniform(-1, 1)), 0
        self.patience = int(self.np_random.integers(3, 9))
        self.calls.append("reset")
        return self._seen(), {}

    def step(self, action):
        self.calls.append("step")
        self.at += float(action[0]) + self.slope
        self.step_count += 1
        fell, late = abs(self.at) > 3, self.step_count >= self.patience
        return self._seen(), -abs(self.at), fell, late, {"patience": self.patience}

    def _seen(self):
        return np.array([self.at, self.step_count])


class Keyed(Walk):
    """The same, with its observation by key and two actions to choose from."""

    observation_space = Dict({"at": REAL, "eye": Box(-np.inf, np.inf, (4, 4), np.float64)})
    action_space = Discrete(2)

    def step(self, action):
        assert self.action_space.contains(action)
        return super().step(np.array([float(action) - 0.5]))

    def _seen(self):
        return {"at": np.array([self.at]), "eye": np.full((4, 4), self.at)}


class Steer(Module):
    name, writes = "steer", ("push",)
    reads = frozenset({Port("place", "feedback")})

    def __init__(self, gain=0.5):
        self.gain = gain

    def step(self, inputs, memory):
        return {"push": np.clip(self.gain * inputs["place", "feedback"], -1, 1)}, memory


def kept(episode):
    return not episode.terminated and len(episode.rewards) == episode.info["patience"]


def plant(environment=Walk, **options):
    options = {"observes": {"place": 0}, "steps": 20, "succeeded": kept} | options
    return GymnasiumPlant(environment, action="push", **options)


def system(world, modules=None, **options):
    units = {"place": "m", "push": "m", "slope": "m"} | options.pop("units", {})
    return ComposedSystem("walk", world, {"only": modules or [Steer()]}, units, **options)


def trials(built, scenes=SCENES, variant="only", seed=0):
    return built.run(variant, scenes, taps_of(built, Treatment(variant=variant), scenes), seed)
