"""Reports from records and outcome tables: one HTML page, LaTeX, Markdown and the terminal."""

from faultpath.report.html import report_page
from faultpath.report.inputs import ReportInput, Traces
from faultpath.report.interface_drawing import draw_interface
from faultpath.report.interface_terminal import interface_table
from faultpath.report.interface_wiring import StruckPath, struck_paths
from faultpath.report.notebook import notebook_view
from faultpath.report.tables import latex_table, markdown_table
from faultpath.report.terminal import decision
from faultpath.report.write import write_report

__all__ = [
    "ReportInput",
    "StruckPath",
    "Traces",
    "decision",
    "draw_interface",
    "interface_table",
    "latex_table",
    "markdown_table",
    "notebook_view",
    "report_page",
    "struck_paths",
    "write_report",
]
