"""For a verb that shows results: estimates with intervals, tables, and numbers as all pages do."""

from faultpath.api.display import SafeConsole
from faultpath.decisions.sentences.wording import counted, interval, plain
from faultpath.decisions.tables import MISSING, Line, Table, line
from faultpath.decisions.tables.terminal import drawn
from faultpath.statistics.contrast import Contrast
from faultpath.statistics.effects import WindowQuantiles
from faultpath.statistics.estimate import Estimate

__all__ = [
    "MISSING",
    "Contrast",
    "Estimate",
    "Line",
    "SafeConsole",
    "Table",
    "WindowQuantiles",
    "counted",
    "drawn",
    "interval",
    "line",
    "plain",
]
