"""Names that `faultpath.faults` offers."""

import faultpath.faults.kinds as kinds
from faultpath.faults.base import Draws, Intervention, Moment
from faultpath.faults.fault import ALL, Fault, at_readers, describe, reaching, resolve
from faultpath.faults.kinds import *  # noqa: F403 - a new kind is listed there alone
from faultpath.faults.kinds import INTERVENTIONS, AnyIntervention
from faultpath.faults.parse import FaultPreset, parse_fault
from faultpath.faults.recorded import Address, Record, encode_record
from faultpath.faults.text import FaultText

__all__: list[str] = [
    "ALL",
    "INTERVENTIONS",
    "Address",
    "AnyIntervention",
    "Draws",
    "Fault",
    "FaultPreset",
    "FaultText",
    "Intervention",
    "Moment",
    "Record",
    "at_readers",
    "describe",
    "encode_record",
    "parse_fault",
    "reaching",
    "resolve",
]
__all__ += kinds.__all__
