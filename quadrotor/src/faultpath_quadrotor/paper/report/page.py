"""A reproduction as one page that opens without a network."""

from markupsafe import Markup

from faultpath.decisions import RunProvenance, wording
from faultpath.decisions.tables import Table
from faultpath.decisions.tables.html import html
from faultpath.report.frame import render
from faultpath_quadrotor.paper.answers import Reproduction
from faultpath_quadrotor.paper.report import words
from faultpath_quadrotor.paper.report.sweep import sweep_plot


def reproduction_page(
    found: Reproduction, provenance: RunProvenance | None, central: tuple[str, Table] | None
) -> str:
    """Return the whole page as HTML: styles and pictures inside.

    `central` says what became of the paper's central claim here, and where it holds; `None` where
    the run is not about it.
    """
    notes = [note for part in (*found.tables, *found.figures) for note in dict.fromkeys(part.notes)]
    shared = [note for note in dict.fromkeys(notes) if notes.count(note) > 1]
    return render(
        "reproduction.html.j2",
        ("tokens.css", "svg.css", "page.css", "reproduction.css"),
        (),
        found=found,
        ledger=found.ledger,
        central=central
        and {
            "state": central[0],
            "table": Markup(html(central[1])),
            "notes": (*central[1].legend(), *central[1].notes),
        },
        tables=[(table, Markup(html(table, "beside", caption=False))) for table in found.tables],
        footnotes={note: number for number, note in enumerate(shared, 1)},
        sweeps=[{"sweep": sweep, "picture": Markup(sweep_plot(sweep))} for sweep in found.figures],
        provenance=provenance,
        w=wording,
        words=words,
    )
