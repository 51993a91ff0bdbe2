"""What can be done to a reading: interventions, and faults that say where and when."""

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
from faultpath.faults.values import Delay, Erase, Freeze, Hold, Offset, Quantise, Scale

__all__ = [
    "ALL",
    "INTERVENTIONS",
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
    "Scale",
    "Sequence",
    "Shuffle",
    "UniformScale",
    "each_size",
    "parse_fault",
    "resolve",
]
