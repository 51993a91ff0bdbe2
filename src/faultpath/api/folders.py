"""The folder of a finished run: its files, and whether they belong together."""

import json
import math
from collections import Counter
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from faultpath.core.errors import UserError
from faultpath.core.files.parquet import Unreadable
from faultpath.core.files.plain import Misread, model_of
from faultpath.decisions.model import DecisionRecord
from faultpath.decisions.planning import faulted_taps
from faultpath.report.inputs import ReportInput
from faultpath.trials import Deliveries, OutcomeTable, SystemShown
from faultpath.trials.provenance import RunProvenance
from faultpath.trials.store.folder import AGAIN, DELIVERIES, OUTCOMES, TRACES, read_regular, unseal
from faultpath.trials.store.signals import SIGNALS, decode_signals
from faultpath.trials.store.tables import decode_outcomes, decode_traces

RECORD, SYSTEM, MAP, SEARCH = "record.json", "system.json", "map.json", "search.json"
SENSITIVITY = "sensitivity.json"
MADE_FROM = (RECORD, SYSTEM, OUTCOMES, TRACES, DELIVERIES)
"""The files of an audit's folder that its pages are made from, and checked against."""
MAP_MADE_FROM = (MAP, OUTCOMES)
"""Those of a map's."""
SEARCH_MADE_FROM = (SEARCH, OUTCOMES)
"""Those of a search's; its confirming audit has a folder of its own."""
SENSITIVITY_MADE_FROM = (SENSITIVITY, OUTCOMES)
"""Those of a sensitivity analysis."""

_Model = TypeVar("_Model", bound=BaseModel)


def read_run(folder: Path) -> ReportInput:
    """Read all that the pages of an audit are made from.

    Every file is compared with the digest in `provenance.json` first. `UserError` for a file that
    is missing, damaged or changed, and for files that do not belong together.
    """
    provenance = read_provenance(folder)
    contents = unseal(folder, provenance.files, MADE_FROM)
    record = parsed(contents[RECORD], folder / RECORD, DecisionRecord)
    shown = parsed(contents[SYSTEM], folder / SYSTEM, SystemShown)
    deliveries = parsed(contents[DELIVERIES], folder / DELIVERIES, Deliveries)
    decoders = {OUTCOMES: decode_outcomes, TRACES: decode_traces, SIGNALS: decode_signals}
    tables: dict[str, Any] = {SIGNALS: {}}
    for name, decode in decoders.items():
        if name in contents:
            try:
                tables[name] = decode(contents[name])
            except Unreadable as error:
                raise UserError(f"{folder / name} is damaged ({error}): {AGAIN}.") from None
    outcomes = tables[OUTCOMES]
    doubt = _doubt(record, provenance, shown, outcomes, deliveries)
    if doubt:
        raise UserError(f"the files of {folder} do not belong together ({doubt}): {AGAIN}.")
    return ReportInput(record, provenance, shown, outcomes, tables[TRACES], tables[SIGNALS])


def read_provenance(folder: Path) -> RunProvenance:
    """Read how a run was made, with the digests of its files; `UserError` without a sound one."""
    place = folder / "provenance.json"
    return parsed(read_regular(place), place, RunProvenance)


def as_text(record: DecisionRecord) -> str:
    """Return a record as its file holds it."""
    data = record.model_dump(mode="json", exclude=set() if record.earlier else {"earlier"})
    if data["question"]["judged"] is None:
        del data["question"]["judged"]
    return json.dumps(data, indent=2) + "\n"


def parsed(data: bytes, path: Path, model: type[_Model]) -> _Model:
    """Return a file's contents as `model`; `UserError` when they are not that."""
    try:
        return model_of(data, model)
    except Misread as error:
        raise UserError(
            f"{path} is damaged or from another version of faultpath ({error}): {AGAIN}."
        ) from None


def _doubt(
    record: DecisionRecord,
    provenance: RunProvenance,
    shown: SystemShown,
    outcomes: OutcomeTable,
    deliveries: Deliveries,
) -> str:
    """Say what shows that the files are of different runs, or were put together by hand."""
    question = record.question
    arms = (question.baseline, question.repair)
    paths = {path.name for path in record.paths}
    cells = {(cell.variant, cell.path): cell for cell in record.cells}
    expected = {(variant, path) for variant in arms for path in paths}
    trials = Counter((row.variant, row.path) for row in outcomes.rows)
    solved = Counter(
        (row.variant, row.path) for row in outcomes.rows if row.outcome.status == "success"
    )
    if provenance.files[OUTCOMES] != provenance.outcomes_sha256:
        return "provenance gives the outcomes two digests"
    if provenance.library_hash != question.library_hash:
        return "record and provenance name different libraries"
    if tuple(variant.name for variant in shown.variants) != arms:
        return "the system's variants are not those of the question"
    if not paths or set(cells) != expected or set(trials) != expected:
        return "the record and the outcomes have different arms"
    ended = (row.outcome for row in outcomes.rows if not row.outcome.failed)
    untimed = any(math.isnan(outcome.time_s) for outcome in ended)
    if untimed and question.judged is None:
        return "trials of an audit have no time"
    if any(cells[at].trials != trials[at] or cells[at].success != solved[at] for at in expected):
        return "the record and the outcomes count different successes"
    measured = {name for row in outcomes.rows for name in row.outcome.metrics}
    for effect in record.effects:
        if lost := sorted(set(effect.metrics) - measured):
            return f"the record tells of '{lost[0]}', and the outcomes have no such column"
    results = (*record.effects, *record.break_even, *record.break_even_beta)
    if not paths.issuperset(result.path for result in results):
        return "the record has effects on paths that it does not name"
    ends = {path for change in record.changes for path in (change.isolated, change.shared)}
    seeds = all(len(effect.wins) == len(effect.losses) for effect in record.effects)
    if not seeds or not ends.issubset(effect.path for effect in record.effects):
        return "the record has effects that do not fit each other"
    taps = {(c.name, consumer) for c in shown.interface.channels for consumer in c.consumers}
    for path in record.paths:
        faulted = {question.repair: path.faulted, question.baseline: path.baseline_faulted}
        for variant, named in faulted.items():
            if not taps.issuperset((tap.channel, tap.consumer) for tap in named):
                return "the record names taps that the interface has not got"
            try:
                received = faulted_taps(deliveries.at(variant, path.name))
            except KeyError:
                return "the record has arms without receipts"
            if received != named:
                return f"receipts and record differ about the taps that '{path.name}' faulted"
    if not set(deliveries.findings) <= set(record.findings):
        return "the record leaves out a finding of the run"
    return ""
