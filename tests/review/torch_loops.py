"""A loop in torch whose pilot divides by a mass that it gets at its port, or in another way."""

import torch

from faultpath.loop import Module, Plant, Port, Progress, interface_of
from faultpath.streams import generator
from faultpath.taps import Query
from faultpath.trials import Library, LoopSystem, SceneRef, System, Wiring

FACTS = """
name: torches
sources:
- {name: odometer, unit: m, provenance: measured}
- {name: mass_estimate, unit: kg, provenance: estimated}
- {name: order, unit: N, provenance: commanded}
- {name: guess, unit: m, provenance: reconstructed}
channels:
- {name: place, sources: [odometer]}
- {name: mass, sources: [mass_estimate]}
- {name: push, sources: [order]}
- {name: ahead, sources: [guess]}
"""


class Body(Plant):
    name, steps = "body", 6
    senses, shows = ("odometer", "mass_estimate"), ("mass",)
    reads = frozenset({Port("push", "motor")})

    def __init__(self):
        self.mass = None

    def start(self, batch):
        drawn = [generator("torches", s, 0).uniform(size=2) for s in batch.scenes]
        place, mass = (torch.tensor([d[i] for d in drawn]) + 0.5 for i in range(2))
        self.mass = mass
        return {"step": 0, "place": place, "true": {"mass": mass}, "began": place}

    def sense(self, state):
        mass = state["true"]["mass"]
        return {"odometer": state["place"], "mass_estimate": 1.0 * mass, "mass": mass}

    def advance(self, state, inputs):
        moved = 0.1 * inputs["push", "motor"] / state["true"]["mass"]
        return {**state, "step": state["step"] + 1, "place": state["place"] + moved}

    def progress(self, state):
        place = state["place"].detach()
        running = torch.full_like(place, state["step"] < self.steps, dtype=torch.bool)
        times = torch.full_like(place, 0.1 * state["step"])
        return Progress(running, ~running & (place.abs() < 0.4), running & False, times)

    def conditions(self, state):
        return [f"{x:.6f}" for x in state["began"].tolist()], ["calm"] * len(state["began"])


class Normaliser(torch.nn.Module):
    def __init__(self):
        super().__init__()
        self.weight = torch.nn.Parameter(torch.tensor(0.3, dtype=torch.float64))
        self.register_buffer("mass", None)

    def forward(self, value, mass):
        return self.weight * value / (mass if self.mass is None else self.mass)


class Pilot(Module):
    name, writes = "pilot", ("order",)
    reads = frozenset({Port("place", "feedback"), Port("mass", "scale"), Port("ahead", "rollout")})

    def __init__(self, kind, body):
        self.kind, self.body, self.normaliser = kind, body, Normaliser()
        self.truths = ("mass",) if kind == "declared" else ()

    def begin(self, batch):
        if self.kind == "captured":
            self.normaliser.mass = self.body.mass
        if self.kind == "copied":
            return self.body.mass.detach().clone()
        return None

    def step(self, inputs, memory):
        mass = inputs["mass", "scale"] if memory is None else memory
        if self.kind == "declared":
            mass = inputs.truth("mass")
        if self.kind == "numbers":
            mass = torch.tensor(self.body.mass.tolist())
        ahead = inputs["ahead", "rollout"](torch.ones_like(mass))
        order = -self.normaliser(inputs["place", "feedback"] + 0.1 * ahead, mass)
        return {"order": order.detach() if self.kind == "cut" else order}, memory


class Guesser(Module):
    name, writes = "guesser", ("guess",)
    reads = frozenset({Port("mass", "model")})

    def __init__(self, kind, body):
        self.kind, self.body = kind, body

    def step(self, inputs, memory):
        mass = self.body.mass if self.kind == "asked" else inputs["mass", "model"]
        return {"guess": Query(lambda ahead: ahead / mass)}, memory


class Torches(LoopSystem):
    name, control_dt_s = "torches", 0.1
    interface = interface_of(FACTS, (Pilot("", None), Guesser("", None), Body()))
    wirings = {"plain": Wiring("As it is.")}  # noqa: RUF012 - never changed

    def __init__(self, kind):
        self.kind, self.body = kind, Body()

    def plant(self):
        return self.body

    def modules(self, variant, seed):
        return Pilot(self.kind, self.body), Guesser(self.kind, self.body)

    def library(self, name):
        return Library(name, tuple(SceneRef(f"t{i}", i) for i in range(6)), f"{name}-1")


def create(kind: str = "") -> System:
    return Torches(kind)
