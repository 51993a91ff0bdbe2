"""The closed loop, executed: modules declare ports, and who reads what is what runs."""

from faultpath.loop.graph import graph, interface_of
from faultpath.loop.loop import Deliverer, Instant, Loop
from faultpath.loop.module import (
    Batch,
    Graph,
    Memory,
    Module,
    Outputs,
    Part,
    Plant,
    Progress,
    State,
    consumers,
)
from faultpath.loop.ports import Inputs, Port

__all__ = [
    "Batch",
    "Deliverer",
    "Graph",
    "Inputs",
    "Instant",
    "Loop",
    "Memory",
    "Module",
    "Outputs",
    "Part",
    "Plant",
    "Port",
    "Progress",
    "State",
    "consumers",
    "graph",
    "interface_of",
]
