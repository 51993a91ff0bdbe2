"""Tables of text, and how terminal, Markdown and HTML show them."""

from faultpath.report.tables.model import MISSING, Entry, Line, Table, line

__all__ = ["MISSING", "Entry", "Line", "Table", "line"]
