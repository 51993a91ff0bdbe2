"""In the text on planning and perception: scenes that no model decides, and other planners."""

from collections.abc import Callable

from faultpath.record import wording
from faultpath.studies.cells import of_seed
from faultpath.studies.contrasts import COMPARED, comparison
from faultpath.studies.entries import Group, Made, bracket
from faultpath.studies.notes import INTERVALS, LEAST, WINS
from faultpath.studies.page import Page, Row, TableSpec
from faultpath.studies.pages.in_text import CEILING, OTHER_PLANNERS, REFERENCE_PLANNER
from faultpath.studies.published import published
from faultpath.studies.quantities.summaries import Bools, in_all, in_none, share
from faultpath.studies.results import Results
from faultpath.tables import MISSING

_PAPER = published("in_text", "ceiling_eight_configurations")


def _alike(label: str, key: str, of: Callable[[Bools], Bools]) -> Row:
    def make(results: Results) -> Made:
        found = share(CEILING, of)(results)
        ends = MISSING if found.interval is None else bracket(found.interval)
        return wording.plain(found.value, 0), ends

    return Row(label, (Group(make, (str(_PAPER[key]), ""), tuple(map(of_seed, CEILING))),))


PAGE = Page(
    "text-planning",
    "What planning and perception decide",
    (
        TableSpec(
            name="text-ceiling",
            title="Scenes that end alike in eight configurations (paper, Section VII)",
            columns=("Scenes (%)", "95 % interval"),
            rows=(
                _alike("Succeed in all (%)", "succeed_in_all", in_all),
                _alike("Fail in all (%)", "fail_in_all", in_none),
            ),
            notes=(
                "{flown}",
                "Without wind and with correct calibration: the four predictors, two of them with "
                "ground-truth clearance, and both repaired models.",
                "Interval: 95 % score interval (Wilson's).",
            ),
        ),
        TableSpec(
            name="text-planners",
            title="Other planners minus the reference, selection library (paper, Section VII)",
            columns=COMPARED,
            rows=tuple(
                comparison(label, planner, REFERENCE_PLANNER, other_noise=True)
                for label, planner in OTHER_PLANNERS.items()
            ),
            notes=(
                "{flown}",
                "WM-A among obstacles; the reference draws 512 candidates. Planners that draw "
                "otherwise share scenes and disturbances, but not their noise. The paper says "
                "that none improved success.",
                WINS,
                LEAST,
                INTERVALS,
            ),
        ),
    ),
)
