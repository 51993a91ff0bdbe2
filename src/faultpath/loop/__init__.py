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
from faultpath.loop.taps import Observer, Query, Reading, Taps

__all__ = [
    "Batch",
    "Deliverer",
    "Graph",
    "Inputs",
    "Instant",
    "Loop",
    "Memory",
    "Module",
    "Observer",
    "Outputs",
    "Part",
    "Plant",
    "Port",
    "Progress",
    "Query",
    "Reading",
    "State",
    "Taps",
    "consumers",
    "graph",
    "interface_of",
]
