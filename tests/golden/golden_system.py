"""A system whose trials depend on scene, seed, version and fault, and fail where an option says."""

import numpy as np

from faultpath import System, generator
from faultpath.interface import Channel, Interface, Provenance, Source
from faultpath.loop import Reading
from faultpath.system import (
    Library,
    Metric,
    Outcome,
    SceneRef,
    Status,
    Variant,
)

STEPS = 5
PLANNER, OBSERVER, LIMIT = "planner.thrust", "observer.balance", "limit.ceiling"


class Golden(System):
    """`once` reads the mass at one module only, `twice` at two, `thrice` at three."""

    name, control_dt_s, block_size, trained = "golden", 0.05, 8, True
    metrics = {"distance": Metric(unit="m", better="less")}  # noqa: RUF012 - never changed
    variants = {  # noqa: RUF012 - never changed
        "once": Variant("once", "the planner alone", frozenset({PLANNER})),
        "twice": Variant("twice", "with an observer", frozenset({PLANNER, OBSERVER})),
        "thrice": Variant("thrice", "with a limit too", frozenset({PLANNER, OBSERVER, LIMIT})),
    }
    interface = Interface(
        name="golden",
        sources=(Source(name="mass", unit="kg", provenance=Provenance.ESTIMATED),),
        channels=(Channel(name="mass", sources=("mass",), readers=(PLANNER, OBSERVER, LIMIT)),),
    )

    def __init__(self, fails: str = "") -> None:
        self.fails = fails.split(",")

    def library(self, name):
        return Library(name, tuple(SceneRef(f"s{i:03d}", i) for i in range(120)), "golden-1")

    def run(self, variant, scenes, taps, seed):
        for scene in scenes:
            if f"{variant}/{scene}/{seed}" in self.fails:
                raise ValueError(f"no air in {scene}")
        streams = ("hardness", 0), ("luck", seed), (variant, seed)
        hardness, luck, own = (
            np.array([generator(f"golden/{name}", scene, key).uniform() for scene in scenes])
            for name, key in streams
        )
        position = 1.0 + hardness
        for step in range(STEPS):
            mass = Reading(np.full(len(scenes), 1.0), "mass", step)
            thrust = taps.deliver("mass", PLANNER, mass, step)
            balance = ceiling = 1.0
            if variant in ("twice", "thrice"):
                balance = taps.deliver("mass", OBSERVER, mass, step)
            if variant == "thrice":
                ceiling = taps.deliver("mass", LIMIT, mass, step)
            position = position - 0.5 * position * balance / (thrust * ceiling)
        skill = {"once": 0.09, "twice": 0.06, "thrice": 0.08}[variant]
        missed = np.abs(position) * (0.5 + 0.5 * luck + own)
        return [
            Outcome(
                scene=scene,
                status=Status.SUCCESS if missed[i] < skill else Status.TIMEOUT,
                time_s=STEPS * self.control_dt_s + 0.05 * round(10 * float(missed[i])),
                metrics={"distance": float(missed[i])},
                initial_hash=f"i-{scene}",
                disturbance_hash=f"d-{scene}-{seed}",
                planner_noise_hash="none",
            )
            for i, scene in enumerate(scenes)
        ]


def create(**options: str) -> System:
    return Golden(**options)
