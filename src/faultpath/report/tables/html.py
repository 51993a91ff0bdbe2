"""Tables as HTML: the paper's figure stands small below ours."""

from faultpath.report.tables.escapes import html as escape
from faultpath.report.tables.escapes import unbroken
from faultpath.report.tables.model import Entry, Table


def html(table: Table, style: str = "numbers", *, caption: bool = True) -> str:
    """Return the `table` element, without its notes, with a body for each inner heading."""
    span = len(table.columns) + 1
    corner = f'<th scope="col">{escape(table.corner)}</th>' if table.corner else "<td></td>"
    classes = [' class="word"' if column in table.words else "" for column in table.columns]
    heads = "".join(
        f'<th scope="col"{of}>{escape(column)}</th>'
        for column, of in zip(table.columns, classes, strict=True)
    )
    title = f"<caption>{escape(table.title)}</caption>" if caption else ""
    parts = [f'<table class="{escape(style)}">{title}', f"<thead><tr>{corner}{heads}</tr></thead>"]
    for heading, lines in table.blocks():
        parts.append("<tbody>")
        if heading:
            parts.append(
                f'<tr class="heading"><th scope="rowgroup" colspan="{span}">'
                f"<span>{escape(heading)}</span></th></tr>"
            )
        for line in lines:
            entries = "".join(map(_entry, line.entries, classes))
            entries += "<td></td>" * (span - 1 - len(line.entries))
            label = f"{escape(line.label)}{_aside(line.aside)}"
            parts.append(f'<tr><th scope="row">{label}</th>{entries}</tr>')
        parts.append("</tbody>")
    return "\n".join([*parts, "</table>"])


def _entry(entry: Entry, of_column: str = "") -> str:
    mark = " found" if entry.detected else ""
    alarm = ' class="alarm"' if entry.tone == "bad" else of_column
    theirs = ""
    if entry.published:
        aloud = '<span class="aloud">paper </span>'
        theirs = f'<span class="theirs">{aloud}{escape(entry.published)}</span>'
    text = f"{escape(unbroken(entry.text))}{_aside(entry.aside)}"
    return f'<td{alarm}><span class="ours{mark}">{text}</span>{theirs}</td>'


def _aside(text: str) -> str:
    return f" <small>({escape(text)})</small>" if text else ""
