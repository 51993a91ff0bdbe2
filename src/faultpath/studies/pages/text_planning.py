"""In the text on planning and perception: scenes that no model decides, and other planners."""

from collections.abc import Callable

from faultpath.report import wording
from faultpath.studies.cells import of_seed
from faultpath.studies.contrasts import COMPARED, attempt, comparison
from faultpath.studies.entries import bracket
from faultpath.studies.notes import INTERVALS, LEAST, WINS, flown
from faultpath.studies.page import Built, Page
from faultpath.studies.pages.in_text import CEILING, OTHER_PLANNERS, REFERENCE_PLANNER
from faultpath.studies.published import published
from faultpath.studies.quantities.summaries import Bools, in_all, in_none, share
from faultpath.studies.results import Results
from faultpath.tables import MISSING, Entry, Line, Table

TITLE = "What planning and perception decide"
CELLS = (*map(of_seed, CEILING), REFERENCE_PLANNER, *OTHER_PLANNERS.values())


def build(results: Results) -> Built:
    """Return the tables of this page."""
    return _ceiling(results), _planners(results)


def _ceiling(results: Results) -> Table:
    paper = published("in_text", "ceiling_eight_configurations")
    rows = (
        ("Succeed in all (%)", paper["succeed_in_all"], in_all),
        ("Fail in all (%)", paper["fail_in_all"], in_none),
    )
    return Table(
        name="text-ceiling",
        title="Scenes that end alike in eight configurations (paper, Section VII)",
        columns=("Scenes (%)", "95 % interval"),
        lines=tuple(
            Line(
                label=label,
                entries=attempt(lambda of=alike: _alike(results, of), (str(part), "")),
            )
            for label, part, alike in rows
        ),
        notes=(
            flown(results, map(of_seed, CEILING)),
            "Without wind and with correct calibration: the four predictors, two of them with "
            "ground-truth clearance, and both repaired models.",
            "Interval: 95 % score interval (Wilson's).",
        ),
    )


def _alike(results: Results, of: Callable[[Bools], Bools]) -> tuple[Entry, Entry]:
    """Return the share of scenes in which every configuration succeeds, or in which none does."""
    found = share(CEILING, of)(results)
    ends = MISSING if found.interval is None else bracket(found.interval)
    return Entry(text=wording.plain(found.value or 0.0, 0)), Entry(text=ends)


def _planners(results: Results) -> Table:
    return Table(
        name="text-planners",
        title="Other planners minus the reference, selection library (paper, Section VII)",
        columns=COMPARED,
        lines=tuple(
            comparison(results, label, planner, REFERENCE_PLANNER, other_noise=True)
            for label, planner in OTHER_PLANNERS.items()
        ),
        notes=(
            flown(results, (REFERENCE_PLANNER, *OTHER_PLANNERS.values())),
            "WM-A among obstacles; the reference draws 512 candidates. Planners that draw "
            "otherwise share scenes and disturbances, but not their noise. The paper says that "
            "none improved success.",
            WINS,
            LEAST,
            INTERVALS,
        ),
    )


PAGE = Page("text-planning", TITLE, CELLS, (), build)
