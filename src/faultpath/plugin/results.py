"""For a verb that shows results: estimates with intervals, tables, and the format of numbers."""

from faultpath.analyses.sentences.wording import counted, interval, plain
from faultpath.analyses.tables import MISSING, Line, Table, line
from faultpath.analyses.tables.terminal import drawn
from faultpath.api.display import SafeConsole
from faultpath.stats.contrast import Contrast
from faultpath.stats.estimate import Estimate

__all__ = [
    "MISSING",
    "Contrast",
    "Estimate",
    "Line",
    "SafeConsole",
    "Table",
    "counted",
    "drawn",
    "interval",
    "line",
    "plain",
]
