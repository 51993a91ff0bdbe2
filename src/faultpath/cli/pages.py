"""From a run folder to its pages."""

from pathlib import Path

import pyarrow.parquet as pq
from pydantic import ValidationError

from faultpath.errors import UserError
from faultpath.record import DecisionRecord, RunProvenance
from faultpath.report import ReportInput, write_report
from faultpath.store import read_traces
from faultpath.trials import System


def read_record(folder: Path) -> DecisionRecord:
    """Read `record.json`; `UserError` when it is missing, damaged or of another version."""
    return _read(folder / "record.json", DecisionRecord)


def save_pages(system: System, folder: Path) -> list[Path]:
    """Write report and tables from what the run folder holds; return their paths."""
    record = read_record(folder)
    provenance = _read(folder / "provenance.json", RunProvenance)
    outcomes = pq.read_table(folder / "outcomes.parquet")
    plans = {scene: system.floor_plan(scene) for scene in outcomes["scene"].unique().to_pylist()}
    report = ReportInput(
        record=record,
        provenance=provenance,
        interface=system.interface,
        outcomes=outcomes,
        traces=read_traces(folder / "traces.parquet"),
        plans={scene: plan for scene, plan in plans.items() if plan is not None},
        dt_s=system.control_dt_s,
    )
    return write_report(report, folder)


def _read[Model: (DecisionRecord, RunProvenance)](path: Path, model: type[Model]) -> Model:
    try:
        return model.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        raise UserError(
            f"{path.parent} holds no {path.name}: give the folder of a finished audit."
        ) from None
    except ValidationError:
        raise UserError(
            f"{path} is damaged or of another version of faultpath: run the audit again."
        ) from None
