"""From a run folder to its pages."""

from pathlib import Path

import pyarrow as pa

from faultpath.cli.records import read_provenance, read_record
from faultpath.errors import UserError
from faultpath.report import ReportInput, Traces, write_report
from faultpath.store import read_table, read_traces
from faultpath.trials import System


def save_pages(system: System, folder: Path) -> list[Path]:
    """Write report and tables from what the run folder holds; return their paths.

    `UserError` for a file of the folder that is missing or damaged, and for a library that is no
    longer the one that was flown.
    """
    record = read_record(folder)
    asked = record.question
    if system.library(asked.library).content_hash != asked.library_hash:
        raise UserError(
            f"library '{asked.library}' has changed since {folder} was made: run the audit again "
            "into a new folder."
        )
    provenance = read_provenance(folder)
    outcomes = _table(folder / "outcomes.parquet")
    scenes = {str(scene) for scene in outcomes["scene"].to_pylist()}
    plans = {scene: system.floor_plan(scene) for scene in sorted(scenes)}
    traces = read_traces(folder / "traces.parquet")
    flown = {(at.variant, at.path, at.seed, at.scene): trace for at, trace in traces.items()}
    report = ReportInput(
        record=record,
        provenance=provenance,
        interface=system.interface,
        outcomes=outcomes,
        traces=Traces(flown, system.control_dt_s),
        plans={scene: plan for scene, plan in plans.items() if plan is not None},
    )
    return write_report(report, folder)


def _table(path: Path) -> pa.Table:
    try:
        return read_table(path.read_bytes())
    except (OSError, pa.ArrowInvalid):
        raise UserError(
            f"{path} is missing or damaged: run the audit again with the same --out."
        ) from None
