"""The closed loop, executed: modules declare ports, and who reads what is what runs."""

from faultpath.loop.graph import graph, interface_of
from faultpath.loop.loop import Clock, Instant, Loop
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
from faultpath.loop.trace import Read, Trace

__all__ = [
    "Batch",
    "Clock",
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
    "Read",
    "State",
    "Trace",
    "consumers",
    "graph",
    "interface_of",
]
