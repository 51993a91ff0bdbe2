"""Building blocks of a user's system: parts, interface, the loop that runs them, adapters.

Each name loads what it needs when it is first used.
"""

from typing import TYPE_CHECKING

from faultpath.core.lazy import load

if TYPE_CHECKING:
    from faultpath.interface import (
        Channel,
        Interface,
        Provenance,
        Source,
        Uncertainty,
        read_interface,
    )
    from faultpath.loop.graph import interface_of
    from faultpath.loop.parts import (
        Batch,
        Inputs,
        Memory,
        Module,
        Outputs,
        Plant,
        Port,
        Progress,
        State,
    )
    from faultpath.loop.reading import Query, Reading
    from faultpath.loop.taps import Taps
    from faultpath.system.checks import library_of
    from faultpath.system.composed import ComposedSystem, Parts
    from faultpath.system.declared import FloorPlan, Library, Pillar, Prism, SceneRef, Variant
    from faultpath.system.episodes import Episode, Measure
    from faultpath.system.functions import FunctionPlant
    from faultpath.system.gymnasium import GymnasiumPlant
    from faultpath.system.loop_system import LoopSystem
    from faultpath.system.modules import row_wise, writes
    from faultpath.system.options import Offered, Option
    from faultpath.system.outcome import VEHICLE, Metric, Outcome, Status
    from faultpath.system.sharing import Shared, shared_objects
    from faultpath.system.system import ErrorSum, ErrorTerm, System
    from faultpath.system.tapping import tapped

__all__ = [
    "VEHICLE",
    "Batch",
    "Channel",
    "ComposedSystem",
    "Episode",
    "ErrorSum",
    "ErrorTerm",
    "FloorPlan",
    "FunctionPlant",
    "GymnasiumPlant",
    "Inputs",
    "Interface",
    "Library",
    "LoopSystem",
    "Measure",
    "Memory",
    "Metric",
    "Module",
    "Offered",
    "Option",
    "Outcome",
    "Outputs",
    "Parts",
    "Pillar",
    "Plant",
    "Port",
    "Prism",
    "Progress",
    "Provenance",
    "Query",
    "Reading",
    "SceneRef",
    "Shared",
    "Source",
    "State",
    "Status",
    "System",
    "Taps",
    "Uncertainty",
    "Variant",
    "interface_of",
    "library_of",
    "read_interface",
    "row_wise",
    "shared_objects",
    "tapped",
    "writes",
]

_HOMES = {
    "Batch": "faultpath.loop.parts",
    "Channel": "faultpath.interface",
    "ComposedSystem": "faultpath.system.composed",
    "Episode": "faultpath.system.episodes",
    "ErrorSum": "faultpath.system.system",
    "ErrorTerm": "faultpath.system.system",
    "FloorPlan": "faultpath.system.declared",
    "FunctionPlant": "faultpath.system.functions",
    "GymnasiumPlant": "faultpath.system.gymnasium",
    "Inputs": "faultpath.loop.parts",
    "Interface": "faultpath.interface",
    "Library": "faultpath.system.declared",
    "LoopSystem": "faultpath.system.loop_system",
    "Measure": "faultpath.system.episodes",
    "Memory": "faultpath.loop.parts",
    "Metric": "faultpath.system.outcome",
    "Module": "faultpath.loop.parts",
    "Offered": "faultpath.system.options",
    "Option": "faultpath.system.options",
    "Outcome": "faultpath.system.outcome",
    "Outputs": "faultpath.loop.parts",
    "Parts": "faultpath.system.composed",
    "Pillar": "faultpath.system.declared",
    "Plant": "faultpath.loop.parts",
    "Port": "faultpath.loop.parts",
    "Prism": "faultpath.system.declared",
    "Progress": "faultpath.loop.parts",
    "Provenance": "faultpath.interface",
    "Query": "faultpath.loop.reading",
    "Reading": "faultpath.loop.reading",
    "SceneRef": "faultpath.system.declared",
    "Shared": "faultpath.system.sharing",
    "Source": "faultpath.interface",
    "Status": "faultpath.system.outcome",
    "State": "faultpath.loop.parts",
    "System": "faultpath.system.system",
    "Taps": "faultpath.loop.taps",
    "Uncertainty": "faultpath.interface",
    "VEHICLE": "faultpath.system.outcome",
    "Variant": "faultpath.system.declared",
    "interface_of": "faultpath.loop.graph",
    "library_of": "faultpath.system.checks",
    "read_interface": "faultpath.interface",
    "row_wise": "faultpath.system.modules",
    "shared_objects": "faultpath.system.sharing",
    "tapped": "faultpath.system.tapping",
    "writes": "faultpath.system.modules",
}


def __getattr__(name: str) -> object:
    return load(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
