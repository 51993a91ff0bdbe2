"""What a finished audit left in its folder, read as data: nothing that it names is imported."""

import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import pyarrow as pa
from pydantic import BaseModel

from faultpath.core.errors import UserError
from faultpath.core.files.plain import Misread, model_of
from faultpath.decisions import DecisionRecord, RunProvenance
from faultpath.decisions.planning import struck_taps
from faultpath.report.inputs import ReportInput, Traces
from faultpath.trials import Deliveries, OutcomeTable, SystemShown
from faultpath.trials.store import read_table
from faultpath.trials.store.folder import DELIVERIES, OUTCOMES, TRACES
from faultpath.trials.store.parquet import Unreadable
from faultpath.trials.store.sealed import AGAIN, read_regular, unseal
from faultpath.trials.store.signals import SIGNALS, decode_signals
from faultpath.trials.store.tables import decode_outcomes, decode_traces

RECORD, SYSTEM, MAP = "record.json", "system.json", "map.json"
MADE_FROM = (RECORD, SYSTEM, OUTCOMES, TRACES, DELIVERIES)
"""The files of a run folder that its pages are made from, and checked against."""

_Model = TypeVar("_Model", bound=BaseModel)
_Table = TypeVar("_Table")


def as_text(record: DecisionRecord) -> str:
    """Return a record as its file holds it."""
    absent = set[str]() if record.earlier else {"earlier"}
    return json.dumps(record.model_dump(mode="json", exclude=absent), indent=2) + "\n"


def read_provenance(folder: Path) -> RunProvenance:
    """Read how a run was made, with the digests of its files; `UserError` without a sound one."""
    place = folder / "provenance.json"
    return parsed(read_regular(place), place, RunProvenance)


def read_run(folder: Path) -> tuple[ReportInput, pa.Table]:
    """Read all that the pages of a run are made from, and its trials as an Arrow table.

    Every file is compared with the digest in `provenance.json` first. `UserError` for a file that
    is missing, damaged or changed, and for files that do not belong together.
    """
    provenance = read_provenance(folder)
    held = unseal(folder, provenance.files, MADE_FROM)
    record = parsed(held[RECORD], folder / RECORD, DecisionRecord)
    shown = parsed(held[SYSTEM], folder / SYSTEM, SystemShown)
    deliveries = parsed(held[DELIVERIES], folder / DELIVERIES, Deliveries)
    outcomes = _decoded(held[OUTCOMES], folder / OUTCOMES, decode_outcomes)
    traces = _decoded(held[TRACES], folder / TRACES, decode_traces)
    heard = _decoded(held[SIGNALS], folder / SIGNALS, decode_signals) if SIGNALS in held else {}
    doubts = _doubts(record, provenance, shown, outcomes) or _unlike(record, deliveries)
    if doubts:
        raise UserError(f"the files of {folder} do not belong together ({doubts}): {AGAIN}.")
    read = ReportInput(
        record=record,
        provenance=provenance,
        interface=shown.interface,
        variants=shown.variants,
        outcomes=outcomes,
        traces=Traces(traces, shown.control_dt_s),
        plans=shown.plans,
        signals=heard,
    )
    return read, read_table(held[OUTCOMES])


def parsed(data: bytes, path: Path, model: type[_Model]) -> _Model:
    """Return a file's contents as `model`; `UserError` when they are not that."""
    try:
        return model_of(data, model)
    except Misread as error:
        raise UserError(
            f"{path} is damaged or from another version of faultpath ({error}): {AGAIN}."
        ) from None


def _decoded(data: bytes, path: Path, decode: Callable[[bytes], _Table]) -> _Table:
    try:
        return decode(data)
    except Unreadable as error:
        raise UserError(f"{path} is damaged ({error}): {AGAIN}.") from None


def _doubts(
    record: DecisionRecord, provenance: RunProvenance, shown: SystemShown, outcomes: OutcomeTable
) -> str:
    """Say what shows that the files are of different runs, or were put together by hand."""
    asked = record.question
    arms = (asked.baseline, asked.repair)
    paths = {path.name for path in record.paths}
    cells = {(cell.variant, cell.path): cell for cell in record.cells}
    wanted = {(variant, path) for variant in arms for path in paths}
    trials = Counter((row.variant, row.path) for row in outcomes.rows)
    solved = Counter(
        (row.variant, row.path) for row in outcomes.rows if row.outcome.status == "success"
    )
    if provenance.files[OUTCOMES] != provenance.outcomes_sha256:
        return "provenance gives the outcomes two digests"
    if provenance.library_hash != asked.library_hash:
        return "record and provenance name different libraries"
    if tuple(variant.name for variant in shown.variants) != arms:
        return "the system's variants are not those of the question"
    if not paths or set(cells) != wanted or set(trials) != wanted:
        return "the record and the outcomes have different arms"
    if any(cells[at].trials != trials[at] or cells[at].success != solved[at] for at in wanted):
        return "the record and the outcomes count different successes"
    measured = {name for row in outcomes.rows for name in row.outcome.metrics}
    for effect in record.effects:
        if lost := sorted(set(effect.metrics) - measured):
            return f"the record tells of '{lost[0]}', and the outcomes have no such column"
    effects = [effect.path for effect in record.effects]
    others = [each.path for each in record.break_even]
    if not paths.issuperset(effects + others):
        return "the record has effects on paths that it does not name"
    taps = {(c.name, consumer) for c in shown.interface.channels for consumer in c.consumers}
    struck = {
        (t.channel, t.consumer) for p in record.paths for t in (*p.struck, *p.baseline_struck)
    }
    return "" if struck <= taps else "the record names taps that the interface has not got"


def _unlike(record: DecisionRecord, deliveries: Deliveries) -> str:
    """Say where the record tells something else than the receipts of the taps."""
    asked = record.question
    try:
        for path in record.paths:
            for variant, told in (
                (asked.repair, path.struck),
                (asked.baseline, path.baseline_struck),
            ):
                if struck_taps(deliveries.at(variant, path.name)) != told:
                    return f"receipts and record differ about the taps that '{path.name}' struck"
    except KeyError:
        return "the record has arms without receipts"
    left_out = not set(deliveries.findings) <= set(record.findings)
    return "the record leaves out a finding of the run" if left_out else ""
