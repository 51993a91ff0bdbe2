"""Points on a line: a plant that goes where it is told, and modules that tell it.

`Loops` is a system of it, sound or with a module that does not read as it says.
"""

import re
from dataclasses import dataclass, replace

import numpy as np

from faultpath.loop import Module, Plant, Port, Progress, Query, interface_of
from faultpath.system import Library, LoopSystem, SceneRef, System

FACTS = """
name: line
sources:
- {name: place, unit: m, provenance: measured%s}
- {name: guess, unit: m, provenance: reconstructed}
- {name: field, unit: m, shape: [2], provenance: privileged}
- {name: order, unit: m/s, provenance: commanded}
channels:
- {name: position, sources: [place]}
- {name: guessed, sources: [guess]}
- {name: clearance, sources: [field]}
- {name: action, sources: [order]}
"""
READ = "\n".join(row for row in (FACTS % "").split("\n") if not re.search("guess|clearance", row))
"""What remains where there is only a pilot."""
LAST = {}


@dataclass(frozen=True)
class At:
    step: int
    x: np.ndarray
    start: np.ndarray


class Line(Plant):
    """A scene is a letter: a point begins at its number."""

    name, steps = "line", 8
    senses, shows = ("place", "field"), ("true_place",)
    reads = frozenset({Port("action", "motor")})

    def start(self, batch):
        letters = np.array([ord(scene) - ord("a") + 1.0 for scene in batch.scenes])
        return At(0, letters, letters)

    def sense(self, state):
        def clearance(points):
            return points - state.x[:, None]

        LAST["place"] = state.x
        return {"place": state.x, "field": Query(clearance), "true_place": state.x}

    def advance(self, state, inputs):
        return replace(state, step=state.step + 1, x=state.x + inputs["action", "motor"])

    def progress(self, state):
        running = np.full(len(state.x), state.step < self.steps)
        near = ~running & (np.abs(state.x) < 0.1)
        return Progress(running, near, running & False, np.full(len(state.x), 0.1 * state.step))

    def conditions(self, state):
        return [f"{start:g}" for start in state.start], ["calm"] * len(state.x)


class Guess(Module):
    """Remembers what it was told at every step."""

    name, writes = "observer", ("guess",)
    reads = frozenset({Port("position", "seen")})
    reads_past = frozenset({Port("action", "executed")})

    def __init__(self):
        self.seen, self.executed = [], []

    def step(self, inputs, memory):
        self.seen.append(inputs["position", "seen"].copy())
        self.executed.append(inputs["action", "executed"].copy())
        return {"guess": inputs["position", "seen"]}, memory


class Planner(Module):
    """Orders the step number, and asks the clearance as often as it is told to."""

    name, writes = "planner", ("order",)
    reads = frozenset({Port("guessed", "start"), Port("clearance", "cost")})

    def __init__(self, asks=1):
        self.asks, self.answers = asks, []

    def before(self, batch):
        return {"order": np.full(len(batch.scenes), -1.0)}

    def step(self, inputs, memory):
        ask = inputs["clearance", "cost"]
        points = np.zeros((len(inputs["guessed", "start"]), 2))
        self.answers.append([ask(points) for _ in range(self.asks)])
        return {"order": np.full(len(points), float(inputs.step))}, memory


class Pilot(Module):
    name, writes = "pilot", ("order",)
    reads = frozenset({Port("position", "feedback")})

    def __init__(self, broken):
        self.broken = broken

    def step(self, inputs, memory):
        if self.broken == "undeclared port":
            inputs["position", "other"]
        if self.broken == "undeclared truth":
            inputs.truth("true_place")
        place = inputs["position", "feedback"]
        match self.broken:
            case "goes round":
                place = LAST["place"]
            case "goes round, still":
                place = 0.0 * LAST["place"]
            case "ignores":
                place = np.full(len(place), 0.1 * inputs.step)
        return {"order": -0.5 * place}, memory


class Loops(LoopSystem):
    name, control_dt_s = "loops", 0.1
    interface = interface_of(READ, (Pilot(""), Line()))
    descriptions = {"plain": "As it is."}  # noqa: RUF012 - never changed

    def __init__(self, broken):
        self.broken = broken

    def plant(self):
        return Line()

    def modules(self, variant, seed):
        return (Pilot(self.broken),)

    def library(self, name):
        return Library(name, tuple(SceneRef(s, i) for i, s in enumerate("abcdef")), f"{name}-1")


def create(broken: str = "") -> System:
    return Loops(broken)
