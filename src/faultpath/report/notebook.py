"""A decision as a notebook shows it: verdict, effects, table; no script, nothing from outside."""

from markupsafe import Markup

from faultpath.record.model import DecisionRecord
from faultpath.report import figures, wording
from faultpath.report.frame import fragment
from faultpath.report.svg import template
from faultpath.report.tables import SHOWN, by_path
from faultpath.tables.html import html


def notebook_view(record: DecisionRecord) -> str:
    """Return HTML for one cell's output; its colours and rules stay within it."""
    asked = record.question
    styles = template("tokens.css").replace(":root", ".faultpath") + template("svg.css")
    return fragment(
        "notebook.html.j2",
        styles=Markup(styles + template("notebook.css")),
        record=record,
        table=Markup(html(by_path(record, SHOWN), caption=False)),
        forest=Markup(figures.forest(figures.effect_rows(record), asked.baseline, asked.repair)),
        w=wording,
    )
