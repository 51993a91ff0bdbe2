"""A point that modules pull to its goal by the mass they read, in a loop of its own.

`ToySystem` has options that make it slow, make it fail, or make its process die; `Golden` ends as
the stored numbers need it.
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

READERS = ("planner.thrust", "observer.balance", "limit.ceiling")


class Weighed(System):
    """Variants read the mass at the first one, two or three `READERS`."""

    control_dt_s, steps, pull, near, traced = 0.05, 12, 0.3, 0.15, True
    reads: Mapping[str, int]
    says: Mapping[str, int]
    """By variant, at how many of the readers it reads, and at how many it says that it does."""
    metrics = {"distance": Metric(unit="m", better="less")}  # noqa: RUF012 - never changed

    @property
    def interface(self) -> Interface:
        readers = READERS[: max(self.says.values())]
        return Interface(
            name=self.name,
            sources=(Source(name="mass", unit="kg", provenance=Provenance.ESTIMATED),),
            channels=(Channel(name="mass", sources=("mass",), readers=readers),),
        )

    @property
    def variants(self) -> Mapping[str, Variant]:
        return {v: Variant(v, f"{n} read", frozenset(READERS[:n])) for v, n in self.says.items()}

    def start(self, scenes: Sequence[str], seed: int) -> np.ndarray:
        return np.array([generator("initial", s, seed).uniform(1, 3) for s in scenes])

    def wind(self, scenes: Sequence[str], seed: int, step: int) -> np.ndarray:
        return np.array([generator("wind", s, seed, step).normal(0, 0.1) for s in scenes])

    def missed(self, position: np.ndarray, variant: str, scenes: Sequence[str], seed: int):
        """Return by how much each scene misses, and where that is a success."""
        distance = np.abs(position)
        return distance, distance < self.near

    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> list[Outcome]:
        position = start = self.start(scenes, seed)
        trace = np.zeros((self.steps, len(scenes), 3), dtype=np.float32)
        for step in range(self.steps):
            mass = Reading(np.full(len(scenes), 1.0), "mass", step)
            read = [taps.deliver("mass", r, mass, step) for r in READERS[: self.reads[variant]]]
            thrust, balance, ceiling, *_ = (*read, 1.0, 1.0)
            position = position - self.pull * position * balance / (thrust * ceiling)
            position = position + self.wind(scenes, seed, step)
            trace[step, :, 0] = position
        missed, won = self.missed(position, variant, scenes, seed)
        return [
            Outcome(
                scene=scene,
                status=Status.SUCCESS if won[i] else Status.TIMEOUT,
                time_s=self.steps * self.control_dt_s + 0.05 * round(10 * float(missed[i])),
                metrics={"distance": float(missed[i])},
                initial_hash=f"{start[i]:.12f}",
                disturbance_hash=f"{scene}-{seed}",
                planner_noise_hash="none",
                trace=trace[:, i] if self.traced else None,
            )
            for i, scene in enumerate(scenes)
        ]


class ToySystem(Weighed):
    name, block_size = "toy", 4
    reads = {"plain": 1, "observed": 2, "deaf": 1, "nosy": 2}  # noqa: RUF012 - never changed
    says = {"plain": 1, "observed": 2, "deaf": 2, "nosy": 1}  # noqa: RUF012 - never changed

    def __init__(self, **options: str) -> None:
        self._options = options

    def library(self, name: str) -> Library:
        kinds = ("open", "narrow")
        scenes = tuple(SceneRef(f"s{i:02d}", i, kinds[i % 2]) for i in range(10))
        return Library(name, scenes, f"{name}-1")

    def fingerprint(self) -> str:
        return self._options.get("fingerprint", "toy-1")

    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> list[Outcome]:
        self._misbehave(variant, scenes, seed)
        return super().run(variant, scenes, taps, seed)

    def _misbehave(self, variant: str, scenes: Sequence[str], seed: int) -> None:
        options = self._options
        if log := options.get("log"):
            with Path(log).open("a") as file:  # one short write: whole, whoever else appends
                file.write(f"{variant} {seed} {','.join(scenes)} {os.getpid()}\n")
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


class Golden(Weighed):
    """Depends on scene, seed, variant and fault, and fails where `fails` has VARIANT/SCENE/SEED."""

    name, block_size, trained, traced = "golden", 120, True, False
    steps, pull = 5, 0.5
    reads = says = {"once": 1, "twice": 2, "thrice": 3}  # noqa: RUF012 - never changed

    def __init__(self, fails: str = "") -> None:
        self.fails = fails.split(",")

    def library(self, name: str) -> Library:
        return Library(name, tuple(SceneRef(f"s{i:03d}", i) for i in range(120)), "golden-1")

    def start(self, scenes: Sequence[str], seed: int) -> np.ndarray:
        return 1.0 + self._drawn("hardness", scenes, 0)

    def wind(self, scenes: Sequence[str], seed: int, step: int) -> np.ndarray:
        return np.zeros(len(scenes))

    def missed(self, position: np.ndarray, variant: str, scenes: Sequence[str], seed: int):
        luck, own = self._drawn("luck", scenes, seed), self._drawn(variant, scenes, seed)
        missed = np.abs(position) * (0.5 + 0.5 * luck + own)
        return missed, missed < {"once": 0.09, "twice": 0.06, "thrice": 0.08}[variant]

    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> list[Outcome]:
        for scene in scenes:
            if f"{variant}/{scene}/{seed}" in self.fails:
                raise ValueError(f"no air in {scene}")
        return super().run(variant, scenes, taps, seed)

    def _drawn(self, what: str, scenes: Sequence[str], seed: int) -> np.ndarray:
        return np.array([generator(f"golden/{what}", s, seed).uniform() for s in scenes])


def create(**options: str) -> System:
    return ToySystem(**options)


def golden(**options: str) -> System:
    return Golden(**options)


def impostor() -> System:
    return object()  # pyright: ignore[reportReturnType] - the mistake that it makes


def needy() -> System:
    raise ModuleNotFoundError("No module named 'torch'", name="torch")
