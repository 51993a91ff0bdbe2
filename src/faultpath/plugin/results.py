"""For a verb that shows results: estimates with intervals, tables, and the format of numbers."""

from faultpath.api.display import SafeConsole
from faultpath.core.text import counted
from faultpath.report.sentences.wording import interval, plain
from faultpath.report.tables import MISSING, Line, Table, line
from faultpath.report.terminal import drawn
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
