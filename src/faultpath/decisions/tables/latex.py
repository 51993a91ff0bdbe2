r"""Tables as LaTeX with booktabs: our figures, and the paper's in a row below them."""

from collections.abc import Iterable

from faultpath.decisions.tables.escapes import latex as escape
from faultpath.decisions.tables.model import Entry, Line, Table

PREAMBLE = r"""\documentclass{article}
\usepackage[T1]{fontenc}
\usepackage[utf8]{inputenc}
\usepackage[margin=2cm]{geometry}
\usepackage{booktabs}
\begin{document}
"""
WIDE = 3
"""More columns than this span both columns of a two-column page."""


def booktabs(table: Table) -> str:
    r"""Return a `table` environment, labelled `tab:NAME`, that needs booktabs and nothing else."""
    environment = "table*" if len(table.columns) > WIDE else "table"
    sides = "".join("l" if column in table.words else "c" for column in table.columns)
    body = [row for line in table.lines for row in _rows(line, len(table.columns))]
    notes = "\n\n".join(escape(note) for note in (*table.legend(), *table.notes))
    return "\n".join(
        [
            rf"\begin{{{environment}}}[t]",
            rf"\caption{{{escape(table.title)}.}}",
            rf"\label{{tab:{table.name}}}",
            r"\centering\footnotesize",
            r"\setlength{\tabcolsep}{4pt}",
            rf"\begin{{tabular}}{{@{{}}l{sides}@{{}}}}",
            r"\toprule",
            " & ".join(map(escape, (table.corner, *table.columns))) + r" \\",
            r"\midrule",
            *body,
            r"\bottomrule",
            r"\end{tabular}",
            r"\par\smallskip\raggedright",
            notes,
            rf"\end{{{environment}}}",
            "",
        ]
    )


def document(tables: Iterable[Table]) -> str:
    r"""Return one document with all tables, each on a page of its own: so many floats need it."""
    pages = (booktabs(table) + "\\clearpage\n" for table in tables)
    return PREAMBLE + "\n".join(pages) + "\\end{document}\n"


def _rows(line: Line, width: int) -> list[str]:
    label = escape(line.label)
    if not line.entries:
        heading = rf"\multicolumn{{{width + 1}}}{{@{{}}l}}{{\emph{{{label}}}}} \\"
        return [r"\addlinespace", heading]
    label += f" ({escape(line.aside)})" if line.aside else ""
    # Braces keep a leading bracket from being read as an argument of the row end before it.
    rows = [" & ".join([f"{{{label}}}", *map(_ours, line.entries)]) + r" \\"]
    if any(entry.published for entry in line.entries):
        rows.append(" & ".join(["", *map(_published, line.entries)]) + r" \\")
    return rows


def _ours(entry: Entry) -> str:
    text = escape(entry.text)
    text = rf"\textbf{{{text}}}" if entry.detected or entry.tone == "bad" else text
    return f"{text} ({escape(entry.aside)})" if entry.aside else text


def _published(entry: Entry) -> str:
    return f"({escape(entry.published)})" if entry.published else ""
