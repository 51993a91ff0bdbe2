"""What can be done to a reading: interventions, and faults that say where and when."""

from faultpath.faults.base import Intervention, Moment
from faultpath.faults.draws import Draws
from faultpath.faults.drift import Bias, Drift
from faultpath.faults.fault import ALL, AnyFault, Coupled, Fault, Window
from faultpath.faults.intermittence import Intermittence, Phases
from faultpath.faults.noise import Noise
from faultpath.faults.parse import FaultPreset, parse_fault
from faultpath.faults.probes import Replace, Shuffle
from faultpath.faults.registry import INTERVENTIONS, AnyIntervention, Sequence
from faultpath.faults.text import FaultText, each_size
from faultpath.faults.timing import Delay, Dropout, Freeze, Hold
from faultpath.faults.values import Erase, Offset, Quantise, Scale, UniformScale

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
    "Intermittence",
    "Intervention",
    "Moment",
    "Noise",
    "Offset",
    "Phases",
    "Quantise",
    "Replace",
    "Scale",
    "Sequence",
    "Shuffle",
    "UniformScale",
    "Window",
    "each_size",
    "parse_fault",
]
