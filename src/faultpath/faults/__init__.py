"""What can be done to a reading: interventions, and faults that say where and when."""

from faultpath.faults.base import Intervention, Moment
from faultpath.faults.clocks import Jitter, Skew
from faultpath.faults.draws import Draws
from faultpath.faults.drift import Bias, Drift
from faultpath.faults.fault import ALL, AnyFault, Coupled, Fault
from faultpath.faults.images import Blur, Exposure, Occlusion, SaltAndPepper, StuckRows
from faultpath.faults.intermittence import Intermittence, Phases
from faultpath.faults.noise import Noise
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
    "Bias",
    "Blur",
    "Coupled",
    "Delay",
    "Draws",
    "Drift",
    "Dropout",
    "Erase",
    "Exposure",
    "Fault",
    "FaultPreset",
    "Freeze",
    "Hold",
    "Intermittence",
    "Intervention",
    "Jitter",
    "Moment",
    "Noise",
    "Occlusion",
    "Offset",
    "Phases",
    "Quantise",
    "Replace",
    "SaltAndPepper",
    "Scale",
    "Sequence",
    "Shuffle",
    "Skew",
    "StuckRows",
    "UniformScale",
    "Window",
    "parse_fault",
]
