"""Names that `faultpath.faults` offers."""

from faultpath.faults.base import Draws, Intervention, Moment
from faultpath.faults.drawn import Bias, Drift, Dropout, Noise, Shuffle, UniformScale
from faultpath.faults.fault import ALL, Fault, at_readers, describe, resolve
from faultpath.faults.kinds import INTERVENTIONS, AnyIntervention, Sequence
from faultpath.faults.parse import FaultPreset, parse_fault
from faultpath.faults.recorded import Address, Record, Recorded, encode_record
from faultpath.faults.text import FaultText
from faultpath.faults.values import Delay, Erase, Freeze, Hold, Offset, Quantise, Rotate, Scale

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
    "resolve",
]
