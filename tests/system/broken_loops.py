"""A loop of parts, sound or with one part that does not read as it says."""

import numpy as np

from faultpath.core.streams import generator
from faultpath.loop import Module, Plant, Port, Progress, interface_of
from faultpath.system import Library, LoopSystem, SceneRef, System, Wiring

FACTS = """
name: loops
sources:
- {name: odometer, unit: m, provenance: measured}
- {name: order, unit: m, provenance: commanded}
- {name: wished, unit: m, provenance: commanded}
channels:
- {name: place, sources: [odometer]}
- {name: move, sources: [order]}
- {name: wish, sources: [wished]}
"""
LAST = {}


class Line(Plant):
    name, steps, senses, shows = "line", 5, ("odometer", "wished"), ("truth",)
    reads = frozenset({Port("move", "motor")})

    def start(self, batch):
        drawn = np.array([generator("loops", s, 0).uniform() for s in batch.scenes])
        return 0, drawn, drawn

    def sense(self, state):
        LAST["place"] = state[1]
        return {"odometer": state[1], "wished": 0.0 * state[1], "truth": state[1]}

    def advance(self, state, inputs):
        return state[0] + 1, state[1] + inputs["move", "motor"], state[2]

    def progress(self, state):
        step, place, _ = state
        running = np.full(len(place), step < self.steps)
        near = np.abs(place) < 0.1
        times = np.full(len(place), 0.1 * step)
        return Progress(running, ~running & near, running & False, times)

    def conditions(self, state):
        return [f"{drawn:.6f}" for drawn in state[2]], ["calm"] * len(state[2])


class Pilot(Module):
    name, writes = "pilot", ("order",)

    def __init__(self, broken):
        self.broken = broken
        self.reads = frozenset({Port("place", "feedback"), Port("wish", "goal")})

    def step(self, inputs, memory):
        if self.broken == "undeclared port":
            inputs["place", "other"]
        if self.broken == "undeclared truth":
            inputs.truth("truth")
        place = inputs["place", "feedback"]
        match self.broken:
            case "goes round":
                place = LAST["place"]
            case "goes round, still":
                place = 0.0 * LAST["place"]
            case "ignores":
                place = np.full(len(place), 0.1 * inputs.step)
        return {"order": 0.5 * (inputs["wish", "goal"] - place)}, memory


class Loops(LoopSystem):
    name, control_dt_s = "loops", 0.1
    interface = interface_of(FACTS, (Pilot(""), Line()))
    wirings = {"plain": Wiring("As it is.")}  # noqa: RUF012 - never changed

    def __init__(self, broken):
        self.broken = broken

    def plant(self):
        return Line()

    def modules(self, variant, seed):
        return (Pilot(self.broken),)

    def library(self, name):
        return Library(name, tuple(SceneRef(f"l{i}", i) for i in range(6)), f"{name}-1")


def create(broken: str = "") -> System:
    return Loops(broken)
