r"""Tables of a study as LaTeX with booktabs: our figures, and the paper's in a row below them."""

from collections.abc import Iterable

from faultpath.record import Entry, Line, Table
from faultpath.report.escapes import latex

LEGEND = "In parentheses: the paper's figures. Bold: a detected difference."
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
    body = [row for line in table.lines for row in _rows(line, len(table.columns))]
    notes = "\n\n".join(latex(note) for note in (LEGEND, *table.notes))
    return "\n".join(
        [
            rf"\begin{{{environment}}}[t]",
            rf"\caption{{{latex(table.title)}.}}",
            rf"\label{{tab:{table.name}}}",
            r"\centering\footnotesize",
            r"\setlength{\tabcolsep}{4pt}",
            rf"\begin{{tabular}}{{@{{}}l{'c' * len(table.columns)}@{{}}}}",
            r"\toprule",
            " & ".join(["", *map(latex, table.columns)]) + r" \\",
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


def booktabs_document(tables: Iterable[Table]) -> str:
    r"""Return one document with all tables, each on a page of its own: so many floats need it."""
    pages = (booktabs(table) + "\\clearpage\n" for table in tables)
    return PREAMBLE + "\n".join(pages) + "\\end{document}\n"


def _rows(line: Line, width: int) -> list[str]:
    label = latex(line.label)
    if not line.entries:
        heading = rf"\multicolumn{{{width + 1}}}{{@{{}}l}}{{\emph{{{label}}}}} \\"
        return [r"\addlinespace", heading]
    # Braces keep a leading bracket from being read as an argument of the row end before it.
    rows = [" & ".join([f"{{{label}}}", *map(_ours, line.entries)]) + r" \\"]
    if any(entry.published for entry in line.entries):
        rows.append(" & ".join(["", *map(_published, line.entries)]) + r" \\")
    return rows


def _ours(entry: Entry) -> str:
    text = latex(entry.text)
    return rf"\textbf{{{text}}}" if entry.detected else text


def _published(entry: Entry) -> str:
    return f"({latex(entry.published)})" if entry.published else ""
