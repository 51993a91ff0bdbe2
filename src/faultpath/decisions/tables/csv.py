"""Tables as CSV, one line a row: an inner heading stands in front of each of its lines."""

import csv
from io import StringIO

from faultpath.decisions.tables.escapes import visible
from faultpath.decisions.tables.model import Entry, Table


def csv_text(table: Table) -> str:
    """Return headings and lines, without title and notes."""
    headed = any(heading for heading, _ in table.blocks())
    out = StringIO()
    writer = csv.writer(out, lineterminator="\n")
    first = ("group",) if headed else ()
    writer.writerow((*first, table.corner, *table.columns))
    for heading, lines in table.blocks():
        for line in lines:
            cells = ((heading,) if headed else (), (line.label,), map(_text, line.entries))
            writer.writerow(visible(cell) for part in cells for cell in part)
    return out.getvalue()


def _text(entry: Entry) -> str:
    return f"{entry.text} ({entry.aside})" if entry.aside else entry.text
