"""What can be done to a reading: interventions, and faults that say where and when."""

from faultpath.faults.base import Intervention, Moment
from faultpath.faults.drawn import Bias, Drift, Noise, Shuffle, UniformScale
from faultpath.faults.draws import Draws
from faultpath.faults.fault import ALL, AnyFault, Coupled, Fault
from faultpath.faults.parse import FaultPreset, parse_fault
from faultpath.faults.registry import INTERVENTIONS, AnyIntervention, Sequence
from faultpath.faults.text import FaultText, each_size
from faultpath.faults.timing import Delay, Dropout, Freeze, Hold
from faultpath.faults.values import Erase, Offset, Quantise, Scale

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
]
