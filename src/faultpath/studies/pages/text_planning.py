"""In the text on planning and perception: scenes that no model decides, and other planners."""

import numpy as np

from faultpath.report import wording
from faultpath.statistics import Estimate, success_rate
from faultpath.studies.contrasts import COMPARED, attempt, comparison
from faultpath.studies.entries import interval, of_seed
from faultpath.studies.notes import INTERVALS, LEAST, WINS, flown
from faultpath.studies.page import Built, Page
from faultpath.studies.pages.in_text import CEILING, OTHER_PLANNERS, REFERENCE_PLANNER
from faultpath.studies.published import published
from faultpath.studies.results import NotRun, Results
from faultpath.tables import Entry, Line, Table

TITLE = "What planning and perception decide"
CELLS = (*map(of_seed, CEILING), REFERENCE_PLANNER, *OTHER_PLANNERS.values())


def build(results: Results) -> Built:
    """Return the tables of this page."""
    return _ceiling(results), _planners(results)


def _ceiling(results: Results) -> Table:
    paper = published("in_text", "ceiling_eight_configurations")
    rows = (
        ("Succeed in all (%)", paper["succeed_in_all"], True),
        ("Fail in all (%)", paper["fail_in_all"], False),
    )
    return Table(
        name="text-ceiling",
        title="Scenes that end alike in eight configurations (paper, Section VII)",
        columns=("Scenes (%)", "95 % interval"),
        lines=tuple(
            Line(
                label=label,
                entries=attempt(lambda all_won=won: _alike(results, all_won), (str(share), "")),
            )
            for label, share, won in rows
        ),
        notes=(
            flown(results, map(of_seed, CEILING)),
            "Without wind and with correct calibration: the four predictors, two of them with "
            "ground-truth clearance, and both repaired models.",
            "Interval: 95 % score interval (Wilson's).",
        ),
    )


def _alike(results: Results, won: bool) -> tuple[Entry, Entry]:
    """Return the share of scenes in which every configuration succeeds, or in which none does."""
    share = shared_by_all(results, won)
    return Entry(text=wording.plain(share.value, 0)), interval(share)


def shared_by_all(results: Results, won: bool) -> Estimate:
    """Return the percentage of scenes that all configurations win, or that all lose.

    A scene in which any trial failed does not count.
    """
    ends: list[dict[str, bool]] = []
    for cell in map(of_seed, CEILING):
        pairs = results.contrast(cell, cell).pairs
        ends.append(dict(zip(pairs.scenes, pairs.first.success[:, 0].tolist(), strict=True)))
    scenes = [scene for scene in ends[0] if all(scene in others for others in ends)]
    if not scenes:
        raise NotRun("a scene of all eight configurations")
    alike = np.array([all(end[scene] is won for end in ends) for scene in scenes])
    return success_rate(alike, results.resamples(len(scenes))).estimate()


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
