"""A counter on a line: a plant that goes where it is told, and modules that tell it."""

import contextlib
from dataclasses import dataclass, replace

import numpy as np

from faultpath.faults import resolve
from faultpath.interface import Interface
from faultpath.loop import Batch, Graph, Loop, Module, Plant, Port, Progress, Query, Taps, graph
from faultpath.loop import interface_of as derived
from faultpath.run.check.reads import Enough

DT_S = 0.1
SCENES = ("a", "b")
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


@dataclass(frozen=True)
class At:
    step: int
    x: np.ndarray


class Line(Plant):
    name, steps = "line", 8
    senses, shows = ("place", "field"), ("true_place",)
    reads = frozenset({Port("action", "motor")})

    def start(self, batch):
        return At(0, np.arange(1.0, 1 + len(batch.scenes)))

    def sense(self, state):
        def clearance(points):
            return points - state.x[:, None]

        return {"place": state.x, "field": Query(clearance), "true_place": state.x}

    def advance(self, state, inputs):
        return replace(state, step=state.step + 1, x=state.x + inputs["action", "motor"])

    def progress(self, state):
        never = np.zeros(len(state.x), bool)
        return Progress(np.full(len(state.x), True), never, never, np.full(len(state.x), 0.1))

    def conditions(self, state):
        return ["i"] * len(state.x), ["d"] * len(state.x)


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

    def before(self, batch: Batch):
        return {"order": np.full(len(batch.scenes), -1.0)}

    def step(self, inputs, memory):
        ask = inputs["clearance", "cost"]
        points = np.zeros((len(inputs["guessed", "start"]), 2))
        self.answers.append([ask(points) for _ in range(self.asks)])
        return {"order": np.full(len(points), float(inputs.step))}, memory


def interface_of(parts, place=""):
    return derived(FACTS % place, parts)


def execute(modules, faults=(), place="", trace=None, guard=False, plant=None):
    """Return the instants and the taps of one execution."""
    interface, parts = wired(modules, place, plant)
    asked = {"scenes": SCENES, "dt_s": DT_S, "privileged": ("field",), "guard": guard}
    taps = Taps(interface, resolve(faults, interface), **asked, observer=trace)
    with contextlib.suppress(Enough):
        return list(Loop(interface, parts).execute(Batch(SCENES, 0, DT_S), taps)), taps
    return [], taps


def wired(modules, place="", plant=None) -> tuple[Interface, Graph]:
    plant = plant or Line()
    interface = interface_of((*modules, plant), place)
    return interface, graph(interface, plant, modules)


__all__ = ["At", "Guess", "Line", "Planner", "execute", "interface_of", "wired"]
