"""Evidence measured on recorded windows: what was asked, what was found, and where it is kept.

No tensors and no simulator here: a system measures, and everybody else reads the table.
"""

from faultpath.evidence.model import QUANTITIES, Measurement, Quantity, Recording
from faultpath.evidence.table import EvidenceTable, Measured, Measurer, Progress

__all__ = [
    "QUANTITIES",
    "EvidenceTable",
    "Measured",
    "Measurement",
    "Measurer",
    "Progress",
    "Quantity",
    "Recording",
]
