"""The interface that a system declares: sources, channels, readers, reconstructions."""

from faultpath.interface.declaration import Channel, Gap, Provenance, Source, Uncertainty
from faultpath.interface.interface import (
    Interface,
    groups,
    module_of,
    modules,
    rank,
    transitive_readers,
)
from faultpath.interface.yaml_io import read_interface

__all__ = [
    "Channel",
    "Gap",
    "Interface",
    "Provenance",
    "Source",
    "Uncertainty",
    "groups",
    "module_of",
    "modules",
    "rank",
    "read_interface",
    "transitive_readers",
]
