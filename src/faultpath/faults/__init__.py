"""Interventions on readings, and faults that say where and when they act."""

from faultpath.faults.base import Draws, Intervention, Moment
from faultpath.faults.drawn import Bias, Drift, Dropout, Noise, Shuffle, UniformScale
from faultpath.faults.fault import (
    ALL,
    INTERVENTIONS,
    AnyFault,
    AnyIntervention,
    Coupled,
    Fault,
    Sequence,
    resolve,
)
from faultpath.faults.parse import FaultPreset, FaultText, each_size, parse_fault
from faultpath.faults.recorded import Address, Record, Recorded, encode_record
from faultpath.faults.values import Delay, Erase, Freeze, Hold, Offset, Quantise, Rotate, Scale

__all__ = [
    "ALL",
    "INTERVENTIONS",
    "Address",
    "AnyFault",
    "AnyIntervention",
    "Bias",
    "Coupled",
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
    "each_size",
    "encode_record",
    "parse_fault",
    "resolve",
]
