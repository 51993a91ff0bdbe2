"""A system made of a plant and modules, which the one loop executes."""

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from typing_extensions import override

from faultpath.core.arrays import Array, namespace, to_numpy
from faultpath.interface import Provenance
from faultpath.loop import Batch, Deliverer, Graph, Loop, Module, Plant, Taps, graph, readers
from faultpath.system.arguments import modules_of, plant_of
from faultpath.system.outcome import Outcome, Status, control_steps
from faultpath.system.system import BLOCK, System, Variant

BLOCKS, LARGEST_BLOCK = 64, 500
"""Number of blocks of a large library, enough for many workers, and scenes of one block."""


class LoopSystem(System):
    """A system built from a plant and modules.

    Readers and privileged sources of its variants follow from the modules' ports, and `run` is the
    loop. Its author writes the parts, chooses those of each variant and describes it.
    """

    block_size = None

    @property
    @abstractmethod
    def descriptions(self) -> Mapping[str, str]:
        """Each variant in words, by its name."""

    @abstractmethod
    def plant(self) -> Plant:
        """Return the plant."""

    @abstractmethod
    def modules(self, variant: str, seed: int | None) -> Sequence[Module]:
        """Return the modules of a variant, in any order.

        `seed` is that of the treatment, for trained modules that of their training; with `None`
        only their ports are used, so weights may be blank.
        """

    def bindings(self, variant: str) -> Mapping[str, str]:
        """Return channel to source in a variant, where it is not the channel's first source."""
        del variant
        return {}

    @property
    def variants(self) -> Mapping[str, Variant]:
        """The described variants, with their modules' readers and privileged sources."""
        return self._variants

    @cached_property
    def _variants(self) -> Mapping[str, Variant]:
        variants: dict[str, Variant] = {}
        for name, description in self.descriptions.items():
            parts = self._graph(name, None)
            bound = {parts.bindings[port.channel] for part in parts.parts for port in part.ports}
            privileged = [
                source
                for source in bound
                if self.interface.source(source).provenance is Provenance.PRIVILEGED
            ]
            variants[name] = Variant(
                name,
                description,
                readers(parts.parts),
                self.bindings(name),
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
        """Return the size of the blocks of a library of `scenes` scenes.

        A step of arrays costs hardly more for many scenes than for a few, so a large library has a
        fixed number of blocks, up to a size that limits a block's memory and the work lost with it.
        """
        return self.block_size or min(max(BLOCK, math.ceil(scenes / BLOCKS)), LARGEST_BLOCK)

    @override
    def run(self, variant: str, scenes: Sequence[str], taps: Taps, seed: int) -> list[Outcome]:
        return self.execute(self.loop(variant, seed), scenes, taps, seed)

    def execute(
        self, loop: Loop, scenes: Sequence[str], taps: Deliverer, seed: int
    ) -> list[Outcome]:
        """Execute a variant's `loop`, or a recorded one made from it.

        Override it for a context of its own, such as torch's inference mode.
        """
        plant, batch = loop.graph.plant, Batch(tuple(scenes), seed, self.control_dt_s)
        positions: list[Array] = []
        state = None
        for instant in loop.execute(batch, taps):
            state = instant.state
            positions.append(plant.position(state))
        noise_hashes = [module.noise_hashes(batch) for module in loop.graph.modules]
        by_module = [hashes for hashes in noise_hashes if hashes is not None]
        noise = ["-".join(hashes) for hashes in zip(*by_module, strict=True)]
        noise = noise or ["none"] * len(scenes)
        # This waits for the plant's device, once a batch.
        end = plant.progress(state)
        initial, disturbed = plant.conditions(state)
        succeeded, crashed, times = map(to_numpy, (end.succeeded, end.crashed, end.time_s))
        metrics = {name: to_numpy(values) for name, values in end.metrics.items()}
        traced = positions[0] is not None
        traces = to_numpy(namespace(positions[0]).stack(positions)) if traced else None
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
        modules = modules_of(variant, self.modules(variant, seed))
        return graph(self.interface, plant_of(self.plant()), modules, self.bindings(variant))
