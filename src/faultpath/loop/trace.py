"""Who read what, when: the interface as it ran."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from faultpath.loop.module import Graph, Module
from faultpath.loop.ports import Inputs, Port


@dataclass(frozen=True)
class Read:
    """One port at one step."""

    step: int
    module: str
    port: Port
    source: str
    valid_step: int
    """Step of the reading: before `step` for what is late, held or read of the past."""
    used: bool
    """Whether the module looked at it."""


@dataclass
class Trace:
    """The reads of the first steps of an execution, in the order in which they happened."""

    steps: int = 3
    reads: list[Read] = field(default_factory=list[Read])
    truths: set[tuple[str, str]] = field(default_factory=set[tuple[str, str]])
    """Module and the plant's truth that it takes past all taps."""

    def note(self, graph: Graph, module: Any, inputs: Inputs, valid: dict[Port, int]) -> None:
        """Take down what a part read at a step."""
        if inputs.step >= self.steps:
            return
        if isinstance(module, Module):
            self.truths |= {(module.name, name) for name in module.truths}
        for port in inputs:
            self.reads.append(
                Read(
                    inputs.step,
                    module.name,
                    port,
                    graph.bindings[port.channel],
                    valid[port],
                    port in inputs.used,
                )
            )

    def unused(self) -> Iterator[tuple[str, Port]]:
        """Yield the ports that are declared and that nobody looked at in these steps."""
        seen = {(read.module, read.port): False for read in self.reads}
        for read in self.reads:
            seen[read.module, read.port] |= read.used
        yield from (key for key, used in seen.items() if not used)
