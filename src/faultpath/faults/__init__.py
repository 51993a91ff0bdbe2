"""Faults: interventions on readings, the readers that get them, and when.

Each name loads what it needs when it is first used: reading a fault's text needs no intervention.
"""

from typing import TYPE_CHECKING

from faultpath.core.lazy import load

if TYPE_CHECKING:
    from faultpath.faults.base import Draws, Intervention, Moment
    from faultpath.faults.fault import ALL, Fault, at_readers, describe, reaching, resolve
    from faultpath.faults.kinds import (
        INTERVENTIONS,
        AnyIntervention,
        Bias,
        Delay,
        Drift,
        Dropout,
        Erase,
        Freeze,
        Hold,
        Noise,
        Offset,
        Quantise,
        Recorded,
        Rotate,
        Scale,
        Sequence,
        Shuffle,
        UniformScale,
    )
    from faultpath.faults.parse import FaultPreset, parse_fault
    from faultpath.faults.recorded import Address, Record, encode_record
    from faultpath.faults.text import FaultText

__all__ = [
    "ALL",
    "INTERVENTIONS",
    "Address",
    "AnyIntervention",
    "Bias",
    "Delay",
    "Draws",
    "Drift",
    "Dropout",
    "Erase",
    "Fault",
    "FaultPreset",
    "FaultText",
    "Freeze",
    "Hold",
    "Intervention",
    "Moment",
    "Noise",
    "Offset",
    "Quantise",
    "Record",
    "Recorded",
    "Rotate",
    "Scale",
    "Sequence",
    "Shuffle",
    "UniformScale",
    "at_readers",
    "describe",
    "encode_record",
    "parse_fault",
    "reaching",
    "resolve",
]

_HOMES = dict.fromkeys(__all__, "faultpath.faults.kinds") | {
    "ALL": "faultpath.faults.fault",
    "Address": "faultpath.faults.recorded",
    "Draws": "faultpath.faults.base",
    "Fault": "faultpath.faults.fault",
    "FaultPreset": "faultpath.faults.parse",
    "FaultText": "faultpath.faults.text",
    "Intervention": "faultpath.faults.base",
    "Moment": "faultpath.faults.base",
    "Record": "faultpath.faults.recorded",
    "at_readers": "faultpath.faults.fault",
    "describe": "faultpath.faults.fault",
    "encode_record": "faultpath.faults.recorded",
    "parse_fault": "faultpath.faults.parse",
    "reaching": "faultpath.faults.fault",
    "resolve": "faultpath.faults.fault",
}
"""Module of each name; every name that is not listed is a kind of fault."""


def __getattr__(name: str) -> object:
    return load(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
