"""A system that is nothing but its parts: a plant and modules, executed by the one loop."""

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from typing_extensions import override

from faultpath.core.arrays import Array, namespace, to_numpy
from faultpath.interface import Provenance
from faultpath.loop import Batch, Deliverer, Graph, Loop, Module, Plant, Taps, graph, readers
from faultpath.system.outcome import Outcome, Status, control_steps
from faultpath.system.system import BLOCK, System, Variant

BLOCKS, LARGEST_BLOCK = 64, 500
"""Blocks of a large library, enough for many workers, and scenes of a block."""


@dataclass(frozen=True)
class Wiring:
    """Description and bindings of a variant, beside its modules."""

    description: str
    bindings: Mapping[str, str] = field(default_factory=dict[str, str])
    """Channel to source, where it is not the channel's first source."""


class LoopSystem(System):
    """A system built from a plant and modules.

    Readers and privileged sources of its variants follow from the modules' ports, and `run` is
    the loop. Its author writes the parts, and says which of them each variant has.
    """

    block_size = None

    @property
    @abstractmethod
    def wirings(self) -> Mapping[str, Wiring]:
        """The variants by name."""

    @abstractmethod
    def plant(self) -> Plant:
        """Return what senses and is moved."""

    @abstractmethod
    def modules(self, variant: str, seed: int | None) -> Sequence[Module]:
        """Return the modules of a variant, in any order.

        `seed` is that of the treatment, for trained modules that of their training; with `None`
        only their ports will be looked at, so that weights may be blank.
        """

    @property
    def variants(self) -> Mapping[str, Variant]:
        """The wirings, with what their modules read."""
        return self._variants

    @cached_property
    def _variants(self) -> Mapping[str, Variant]:
        variants: dict[str, Variant] = {}
        for name, wiring in self.wirings.items():
            parts = self._graph(name, None)
            bound = {parts.bindings[port.channel] for part in parts.parts for port in part.ports}
            privileged = [
                source
                for source in bound
                if self.interface.source(source).provenance is Provenance.PRIVILEGED
            ]
            variants[name] = Variant(
                name,
                wiring.description,
                readers(parts.parts),
                wiring.bindings,
                frozenset(privileged),
            )
        return variants

    def loop(self, variant: str, seed: int | None) -> Loop:
        """Return the executable loop of a variant.

        Raises `SystemMistake` where its parts do not fit together; see `faultpath.loop.graph`.
        """
        return Loop(self.interface, self._graph(variant, seed))

    @override
    def scenes_a_block(self, scenes: int) -> int:
        """Return the size of the blocks of a library with so many scenes.

        A step of arrays costs hardly more for many scenes than for a few, so a large library has so
        many blocks and no more, up to a size that bounds what a block keeps in memory and what is
        lost where one ends early.
        """
        return self.block_size or min(max(BLOCK, math.ceil(scenes / BLOCKS)), LARGEST_BLOCK)

    @override
    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> list[Outcome]:
        return self.execute(self.loop(variant, seed), scenes, taps, seed)

    def execute(
        self, loop: Loop, scenes: Sequence[str], taps: Deliverer, seed: int
    ) -> list[Outcome]:
        """Execute a variant's `loop`, or one made from it that is recorded.

        A system whose loops run in a context of their own, such as torch's inference mode,
        overrides this.
        """
        plant, batch = loop.graph.plant, Batch(tuple(scenes), seed, self.control_dt_s)
        path: list[Array] = []
        state = None
        for instant in loop.execute(batch, taps):
            state = instant.state
            path.append(plant.position(state))
        drawn = [h for part in loop.graph.modules if (h := part.noise_hashes(batch)) is not None]
        noise = ["-".join(hashes) for hashes in zip(*drawn, strict=True)] or ["none"] * len(scenes)
        # Reading the end of the trials waits for the plant's device, once a batch.
        end = plant.progress(state)
        initial, disturbed = plant.conditions(state)
        succeeded, crashed, times = map(to_numpy, (end.succeeded, end.crashed, end.time_s))
        metrics = {name: to_numpy(values) for name, values in end.metrics.items()}
        traced = path[0] is not None
        traces = to_numpy(namespace(path[0]).stack(path)) if traced else None
        outcomes: list[Outcome] = []
        for i, scene in enumerate(batch.scenes):
            time_s = float(times[i])
            steps = control_steps(time_s, batch.dt_s)
            status = Status.SUCCESS if succeeded[i] else Status.TIMEOUT
            outcomes.append(
                Outcome(
                    scene=scene,
                    status=Status.CRASH if crashed[i] else status,
                    time_s=time_s,
                    initial_hash=initial[i],
                    disturbance_hash=disturbed[i],
                    planner_noise_hash=noise[i],
                    metrics={name: float(values[i]) for name, values in metrics.items()},
                    trace=None if traces is None else traces[: steps + 1, i].astype(np.float32),
                )
            )
        return outcomes

    def _graph(self, variant: str, seed: int | None) -> Graph:
        bindings = self.wirings[variant].bindings
        return graph(self.interface, self.plant(), self.modules(variant, seed), bindings)
