"""Why an outdated wind costs little: the reconstructed wind frozen from other steps on.

    python tools/frozen_wind.py RUN_FOLDER    where its trials are kept

Flies the reconstruction of the paper's freeze in free space at L3, on the selection library and on
the default platform: updated, frozen from a control step on, and without any wind input. Writes
`docs/reference/frozen-wind.json`.
"""

import sys
from pathlib import Path

from blocks import REFERENCE
from rich.progress import Progress

from faultpath.evidence import EvidenceTable
from faultpath.studies.cells import PROFILES, Cell
from faultpath.studies.contrasts import COMPARED, comparison
from faultpath.studies.flights import Pace, fly
from faultpath.studies.notes import INTERVALS, LEAST, WINS
from faultpath.studies.page import Page, TableSpec
from faultpath.studies.pages.in_text import SELECTION_FREE_L3
from faultpath.studies.pages.table_3 import TRAJECTORY, ZERO
from faultpath.studies.run import Plan
from faultpath.tables import Table
from faultpath.work import local

STEPS = (0, 1, 2, 5, 10, 20, 40)
"""Control steps of 0.05 s at which the wind is frozen; the paper's is 20."""
UPDATED = Cell(SELECTION_FREE_L3, TRAJECTORY)


def _frozen(step: int) -> Cell:
    return Cell(SELECTION_FREE_L3, TRAJECTORY, (f"wind:freeze,onset={step}",))


PAGE = Page(
    "frozen-wind",
    "Experiment on the frozen wind",
    (
        TableSpec(
            name="frozen-wind",
            title="Trajectory GRU's wind frozen from a control step on, minus updated, "
            "free space at L3",
            columns=COMPARED,
            rows=(
                *(comparison(f"Step {step}", _frozen(step), UPDATED) for step in STEPS),
                comparison("No wind input", Cell(SELECTION_FREE_L3, ZERO), UPDATED),
            ),
            notes=("{flown}", WINS, LEAST, INTERVALS),
        ),
    ),
)


def main() -> int:
    """Fly and write; return the exit status."""
    if len(sys.argv) != 2:
        print((__doc__ or "").partition("\n\n")[2], file=sys.stderr)
        return 2
    plan = Plan((PAGE,), PROFILES["paper"])
    legs = plan.legs()
    with Progress() as bar, local(2) as hands:
        task = bar.add_task("Frozen wind", total=sum(leg.trials for leg in legs))

        def show(pace: Pace) -> None:
            bar.update(task, completed=pace.trials_done)

        flown = fly(legs, Path(sys.argv[1]), hands, show, bar.console.print)
    results = plan.results(flown.outcomes, EvidenceTable({}))
    (table,) = (part for part in PAGE.build(results) if isinstance(part, Table))
    (REFERENCE / "frozen-wind.json").write_text(table.model_dump_json(indent=1) + "\n", "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
