"""What a system declares: sources, channels, consumers, reconstructions."""

from faultpath.interface.graph import (
    Ranked,
    direct_consumers,
    feeds,
    groups,
    module_of,
    modules,
    rank,
    transitive_consumers,
)
from faultpath.interface.interface import Interface
from faultpath.interface.model import (
    Channel,
    Gap,
    Provenance,
    Source,
    Uncertainty,
)
from faultpath.interface.yaml_io import (
    interface_yaml,
    json_schema,
    read_interface,
)

__all__ = [
    "Channel",
    "Gap",
    "Interface",
    "Provenance",
    "Ranked",
    "Source",
    "Uncertainty",
    "direct_consumers",
    "feeds",
    "groups",
    "interface_yaml",
    "json_schema",
    "module_of",
    "modules",
    "rank",
    "read_interface",
    "transitive_consumers",
]
