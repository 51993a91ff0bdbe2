"""What can be done to a reading: interventions, and faults that say where and when."""

from faultpath.faults.base import Intervention, Moment
from faultpath.faults.draws import Draws
from faultpath.faults.fault import ALL, AnyFault, Coupled, Fault
from faultpath.faults.noise import Drift, Noise
from faultpath.faults.parse import FaultPreset, parse_fault
from faultpath.faults.probes import Replace, Shuffle
from faultpath.faults.registry import INTERVENTIONS, AnyIntervention, Sequence
from faultpath.faults.timing import Delay, Dropout, Freeze, Hold
from faultpath.faults.values import Erase, Offset, Quantise, Scale, UniformScale
from faultpath.faults.window import Window

__all__ = [
    "ALL",
    "INTERVENTIONS",
    "AnyFault",
    "AnyIntervention",
    "Coupled",
    "Delay",
    "Draws",
    "Drift",
    "Dropout",
    "Erase",
    "Fault",
    "FaultPreset",
    "Freeze",
    "Hold",
    "Intervention",
    "Moment",
    "Noise",
    "Offset",
    "Quantise",
    "Replace",
    "Scale",
    "Sequence",
    "Shuffle",
    "UniformScale",
    "Window",
    "parse_fault",
]
