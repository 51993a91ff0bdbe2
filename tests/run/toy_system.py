"""A closed loop small enough to see through: a point on a line, pulled to its goal.

Its mass reaches two modules. The options make it slow, make it fail, or make its process die.
"""

import os
import signal
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from faultpath.core.streams import generator
from faultpath.interface import Channel, Interface, Provenance, Source
from faultpath.loop import Reading, Taps
from faultpath.system import Library, Metric, SceneRef, System, Variant
from faultpath.system.outcome import Outcome, Status

STEPS = 12
CONSUMERS = ("planner.thrust", "observer.balance")


class ToySystem(System):
    name = "toy"
    control_dt_s = 0.05
    block_size = 4
    metrics = {"distance": Metric(unit="m", better="less")}  # noqa: RUF012 - never changed

    def __init__(self, **options: str) -> None:
        self._options = options

    @property
    def interface(self) -> Interface:
        return Interface(
            name="toy",
            sources=(Source(name="mass", unit="kg", provenance=Provenance.ESTIMATED),),
            channels=(Channel(name="mass", sources=("mass",), readers=CONSUMERS),),
        )

    @property
    def variants(self) -> Mapping[str, Variant]:
        return {
            "plain": Variant("plain", "the planner alone", frozenset({CONSUMERS[0]})),
            "observed": Variant("observed", "with an observer", frozenset(CONSUMERS)),
            "deaf": Variant("deaf", "says that it has an observer", frozenset(CONSUMERS)),
            "nosy": Variant("nosy", "does not say that it has one", frozenset({CONSUMERS[0]})),
        }

    def library(self, name: str) -> Library:
        kinds = ("open", "narrow")
        scenes = tuple(SceneRef(f"s{i:02d}", i, kinds[i % 2]) for i in range(10))
        return Library(name, scenes, f"{name}-1")

    def fingerprint(self) -> str:
        return self._options.get("fingerprint", "toy-1")

    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> list[Outcome]:
        self._misbehave(variant, scenes, seed)
        observed = variant in ("observed", "nosy")
        start = np.array([generator("initial", s, seed).uniform(1, 3) for s in scenes])
        position = start.copy()
        trace = np.zeros((STEPS, len(scenes), 3), dtype=np.float32)
        for step in range(STEPS):
            mass = Reading(np.full(len(scenes), 1.0), "mass", step)
            thrust = taps.deliver("mass", CONSUMERS[0], mass, step)
            pull = 0.3 * position / thrust
            if observed:
                pull *= taps.deliver("mass", CONSUMERS[1], mass, step)
            wind = np.array([generator("wind", s, seed, step).normal(0, 0.1) for s in scenes])
            position = position - pull + wind
            trace[step, :, 0] = position
        return [
            Outcome(
                scene=scene,
                status=Status.SUCCESS if abs(position[i]) < 0.15 else Status.TIMEOUT,
                time_s=STEPS * self.control_dt_s,
                metrics={"distance": float(abs(position[i]))},
                initial_hash=f"{start[i]:.12f}",
                disturbance_hash=f"{scene}-{seed}",
                planner_noise_hash="none",
                trace=trace[:, i],
            )
            for i, scene in enumerate(scenes)
        ]

    def _misbehave(self, variant: str, scenes: Sequence[str], seed: int) -> None:
        options = self._options
        if log := options.get("log"):
            with Path(log).open("a") as file:  # one short write: whole, whoever else appends
                file.write(f"{variant} {seed} {','.join(scenes)} {os.getpid()}\n")
        if Path(options.get("slow_while", "")).is_file():
            time.sleep(0.2)
        while Path(options.get("hang_while", "")).is_file():
            time.sleep(0.01)
        if len(scenes) > 1 and options.get("alone") == variant:
            raise ValueError("the truth value of an array is ambiguous")
        if options.get("raises") in scenes and Path(options.get("while", __file__)).exists():
            raise ValueError(f"no air in {options['raises']}")
        if options.get("dies") in scenes:
            once = options.get("once")
            if once is None or not Path(once).exists():
                if once:
                    Path(once).touch()
                os.kill(os.getpid(), signal.SIGKILL)


def create(**options: str) -> System:
    return ToySystem(**options)


def impostor() -> System:
    return object()  # pyright: ignore[reportReturnType]


def needy() -> System:
    raise ModuleNotFoundError("No module named 'torch'", name="torch")
