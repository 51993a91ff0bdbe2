"""The closed loop, executed: modules declare ports, and every edge between them is a tap."""

from faultpath.loop.delivery_log import DeliveryLog, TapCount, added, check_reached
from faultpath.loop.graph import graph, interface_of
from faultpath.loop.loop import Deliverer, Instant, Loop
from faultpath.loop.parts import (
    Batch,
    Graph,
    Inputs,
    Memory,
    Module,
    Outputs,
    Part,
    Plant,
    Port,
    Progress,
    State,
    readers,
)
from faultpath.loop.reading import (
    FaultedElsewhere,
    IllegalRead,
    MalformedReading,
    NotDelivered,
    NotFinite,
    Query,
    Reading,
    TapError,
    UndeclaredReader,
    WrittenTo,
)
from faultpath.loop.tap import DeliveryListener, Tap
from faultpath.loop.taps import Taps

__all__ = [
    "Batch",
    "Deliverer",
    "DeliveryListener",
    "DeliveryLog",
    "FaultedElsewhere",
    "Graph",
    "IllegalRead",
    "Inputs",
    "Instant",
    "Loop",
    "MalformedReading",
    "Memory",
    "Module",
    "NotDelivered",
    "NotFinite",
    "Outputs",
    "Part",
    "Plant",
    "Port",
    "Progress",
    "Query",
    "Reading",
    "State",
    "Tap",
    "TapCount",
    "TapError",
    "Taps",
    "UndeclaredReader",
    "WrittenTo",
    "added",
    "check_reached",
    "graph",
    "interface_of",
    "readers",
]
