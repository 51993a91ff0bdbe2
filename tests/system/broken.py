"""A point that is pulled to a wall: sound, or broken in one way that a check is to find."""

import hashlib
import itertools

import numpy as np

from faultpath.core.streams import generator
from faultpath.interface import read_interface
from faultpath.loop import Reading
from faultpath.system import (
    Library,
    Metric,
    Outcome,
    SceneRef,
    Status,
    System,
    Variant,
    row_wise,
)

INTERFACE = read_interface("""
name: wall
sources:
- {name: laser, unit: m, provenance: measured, scale: 2.0}
- {name: mass_estimate, unit: kg, provenance: estimated}
- {name: sonar, unit: m, provenance: measured}
channels:
- {name: range, sources: [laser, sonar], readers: [pilot.approach, guard.limit]}
- {name: mass, sources: [mass_estimate], readers: [pilot.thrust]}
""")
DISTANCE = Metric(unit="m", better="less", words="distance", title="Distance left at the end")
PILOT = frozenset({"pilot.approach", "pilot.thrust"})
_CALLS = itertools.count()
_SEEN = set()
_KEPT = np.random.default_rng(0)


class Wall(System):
    name, control_dt_s, interface = "wall", 0.1, INTERFACE
    variants = {  # noqa: RUF012 - never changed
        "bare": Variant("bare", "The pilot alone.", PILOT),
        "guarded": Variant("guarded", "With a guard.", PILOT | {"guard.limit"}),
    }

    metrics = {"terminal_distance_m": DISTANCE}  # noqa: RUF012 - never changed

    def __init__(self, broken: str):
        self.broken = broken
        if broken == "one at a time":
            self.block_size = 1

    def library(self, name):
        same = self.broken == "same index"
        scenes = tuple(SceneRef(f"w{i}", 0 if same else i) for i in range(6))
        return Library(name, scenes, f"{name}-1")

    def run(self, variant, scenes, taps, seed):
        broken, n = self.broken, len(scenes)
        if (broken == "raises" and "w2" in scenes) or (broken == "raises late" and "w4" in scenes):
            raise ValueError("no air")
        assert n <= self.block_size
        draws = np.array([generator("wall", scene, seed).uniform(size=2) for scene in scenes])
        left, mass = (draws * [2.0, 1.0] + [1.0, 1.0]).T
        wind = np.zeros(n)
        match broken:
            case "never repeats":
                wind += 0.001 * next(_CALLS)
            case "hash of a text":
                wind += [(hash(scene) % 1000) / 1e5 for scene in scenes]
            case "random":
                wind += 0.001 * np.random.default_rng().uniform()
            case "kept generator":
                wind += 0.001 * _KEPT.uniform()
            case "by place":
                wind += 0.01 * np.arange(n)
            case "crowded":
                wind += 0.01 * n
            case "rounds" | "last digit":
                wind += 1e-16 * n
            case "barely crowded":
                wind += 1e-9 * n
        net = _network(broken) if "network" in broken else None
        left = left.astype(np.float32) if net else left
        unit = {"millimetres": 1000.0, "whole": 100.0}.get(broken, 1.0)
        for step in range(20):
            shown = np.where((broken == "nan") & (step > 9), np.nan, unit * left)
            shown = shown[:, None] if broken == "shape" else shown
            shown = shown.astype(int) if broken == "whole" else shown
            late = step + (broken == "of the future")
            seen = Reading(shown, "sonar" if broken == "another source" else "laser", late)
            pull = np.nan_to_num(taps.deliver("range", "pilot.approach", seen, step))
            near = pull.min() < 0.2  # which only a fault makes it
            if near and broken == "raises when near":
                raise ValueError("too near")
            known = Reading(mass, "mass_estimate", step)
            thrust = taps.deliver("mass", "pilot.thrust", known, step)
            pull = net(pull) if net else pull
            pull = pull.reshape(n) / unit / (mass if broken == "ignores" else thrust)
            if variant == "guarded" and broken != "deaf" and not _kept(broken, scenes):
                limit = taps.deliver("range", "guard.limit", seen, step) / unit
                pull = np.minimum(pull, np.nan_to_num(limit).reshape(n))
            if broken == "nosy" and variant == "bare":
                taps.deliver("range", "guard.limit", seen, step)
            pull = pull * np.nan if near and broken == "nan when near" else pull
            left = left - 0.1 * (pull + wind)
            left = left[:, None] if near and broken == "shape when near" else left
        left = 0.6 * np.sin(1e16 * left) if broken == "last digit" else left
        ends = zip(scenes, left, draws, strict=True)
        return [_outcome(broken, variant, *end) for end in ends]


def _network(kind):
    """Return a torch module that pulls: as it is, row by row, or with a batch norm."""
    import torch

    layers = [torch.nn.Linear(1, 256), torch.nn.Tanh(), torch.nn.Linear(256, 1)]
    draw = torch.Generator().manual_seed(0)
    with torch.no_grad():
        for layer in (layers[0], layers[2]):
            most = layer.in_features**-0.5
            for weights in layer.parameters():
                weights.uniform_(-most, most, generator=draw)
    if kind == "network with batch norm":
        layers.insert(1, torch.nn.BatchNorm1d(256))
    net = torch.nn.Sequential(*layers)
    call = row_wise(net) if kind == "network row by row" else net

    def pull(seen):
        with torch.no_grad():
            return seen + call(torch.tensor(seen, dtype=torch.float32)[:, None])[:, 0].numpy()

    return pull


def _kept(broken, scenes):
    """Say whether these scenes ran in this process, for one that then reads no more."""
    if broken != "keeps":
        return False
    kept = scenes in _SEEN
    _SEEN.add(scenes) if len(_SEEN) < 3 else None
    return kept


def _outcome(broken, variant, scene, left, draws):
    drawn = hashlib.sha256(draws.tobytes()).hexdigest()[:8]
    disturbed = f"{drawn}-{variant}" if broken == "unpaired" else drawn
    return Outcome(
        scene=scene,
        status=Status.SUCCESS if abs(left) < 0.3 else Status.TIMEOUT,
        time_s=2.0,
        metrics={"terminal_distance_m": abs(float(left))},
        initial_hash="none" if broken == "hashless" else drawn,
        disturbance_hash="none" if broken == "hashless" else disturbed,
        planner_noise_hash="none",
    )


def create(broken: str = "") -> System:
    return Wall(broken)
