"""Table IV's question as an audit: does the repair that wins alone still win with the fault shared?

Its decision record and its flights are what a report shows of the reversal.
"""

from dataclasses import replace

from faultpath.faults import Fault
from faultpath.planning import struck_taps
from faultpath.record import CORRECT, SHARED, DecisionRecord, Path, Question, decide
from faultpath.studies.cells import SYSTEM
from faultpath.studies.flights import Leg
from faultpath.studies.pages import table_4
from faultpath.trials import Deliveries, OutcomeTable, TrialRow, VariantShown, variant_shown

BASELINE, REPAIR = "gru", "gru+dcc"
NAMES = {"correct": CORRECT, "reconstruction-only": "reconstruction", "shared": SHARED}
TITLES = {
    CORRECT: "Correct inputs",
    "reconstruction": "Reconstruction only",
    SHARED: "Shared fault",
}
_PATHS = {table_4.cell(REPAIR, path).path: name for path, name in NAMES.items()}


def concerns(row: TrialRow) -> bool:
    """Return whether a trial is one of the question's."""
    return row.variant in (BASELINE, REPAIR) and row.path in _PATHS


def audited(outcomes: OutcomeTable) -> OutcomeTable:
    """Return the question's trials, by the names that an audit gives their paths."""
    rows = (row for row in outcomes.rows if concerns(row))
    return OutcomeTable(tuple(replace(row, path=_PATHS[row.path]) for row in rows))


def whole(audited: OutcomeTable) -> bool:
    """Return whether both variants were flown on every path."""
    return all(audited.seeds(v, p) for v in (BASELINE, REPAIR) for p in NAMES.values())


def decision(outcomes: OutcomeTable, leg: Leg, deliveries: Deliveries) -> DecisionRecord:
    """Return the decision record over trials that `audited` returned, flown in `leg`.

    `deliveries` say what the taps did there.
    """
    study = leg.study
    question = Question(
        system=SYSTEM,
        options=study.system.options,
        baseline=BASELINE,
        repair=REPAIR,
        fault=table_4.PATHS["shared"][0],
        library=study.library,
        library_hash=leg.system.library(study.library).content_hash,
        n_scenes=len(study.scenes),
        seeds=outcomes.seeds(BASELINE, CORRECT),
        trained=leg.system.trained,
        rule="exact",  # the paper's tests
    )
    paths = [
        Path(
            name=NAMES[path],
            title=TITLES[NAMES[path]],
            consumers=_struck(leg, REPAIR, path),
            baseline_consumers=_struck(leg, BASELINE, path),
            struck=struck_taps(deliveries.at(REPAIR, table_4.cell(REPAIR, path).path)),
            baseline_struck=struck_taps(deliveries.at(BASELINE, table_4.cell(BASELINE, path).path)),
        )
        for path in table_4.PATHS
    ]
    return decide(question, paths, outcomes)


def wired(leg: Leg) -> tuple[VariantShown, ...]:
    """Return how baseline and repair are wired."""
    return tuple(variant_shown(leg.system.variants[name]) for name in (BASELINE, REPAIR))


def _struck(leg: Leg, variant: str, path: str) -> tuple[str, ...]:
    at = table_4.cell(variant, path).path
    row = next(row for row in leg.study.rows if (row.variant, row.path) == (variant, at))
    struck = (f.consumers for f in row.arm.faults if isinstance(f, Fault))  # arms spell them out
    return tuple(dict.fromkeys(consumer for consumers in struck for consumer in consumers))
