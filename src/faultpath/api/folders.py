"""The folder of a finished run: its files, and whether they belong together."""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from itertools import product
from pathlib import Path
from typing import TypeVar

import numpy as np
from pydantic import BaseModel

from faultpath.analyses.audit import faulted_taps
from faultpath.analyses.model import SHARED, AuditResult
from faultpath.core.errors import UserError
from faultpath.core.files.opening import read_regular
from faultpath.core.files.parquet import Unreadable
from faultpath.core.files.plain import Misread, model_of
from faultpath.interface import Interface
from faultpath.report.inputs import ReportInput
from faultpath.run.deliveries import Deliveries
from faultpath.run.provenance import AGAIN, RunProvenance, unseal
from faultpath.run.shown import SystemShown
from faultpath.run.store.folder import DELIVERIES, OUTCOMES, TRACES
from faultpath.run.store.signals import SIGNALS, decode_signals
from faultpath.run.store.tables import decode_outcomes, decode_traces
from faultpath.run.trials import Trials
from faultpath.stats.estimate import ALPHA
from faultpath.system.outcome import Status

RECORD, SYSTEM, MAP, SCAN = "record.json", "system.json", "map.json", "scan.json"
MADE_FROM = (RECORD, SYSTEM, OUTCOMES, TRACES, DELIVERIES)
"""The files of an audit's folder that its pages are made from, and checked against."""
MAP_MADE_FROM = (MAP, OUTCOMES)
"""Those of a map's."""
SCAN_MADE_FROM = (SCAN, OUTCOMES)
"""Those of a scan's."""

_Model = TypeVar("_Model", bound=BaseModel)
_Table = TypeVar("_Table")


def read_run(folder: Path) -> ReportInput:
    """Read all that the pages of an audit are made from.

    Every file is compared with the digest in `provenance.json` first. `UserError` for a file that
    is missing, damaged or changed, and for files that do not belong together.
    """
    provenance = read_provenance(folder)
    contents = unseal(folder, provenance.files, MADE_FROM)
    record = parsed(contents[RECORD], folder / RECORD, AuditResult)
    shown = parsed(contents[SYSTEM], folder / SYSTEM, SystemShown)
    deliveries = parsed(contents[DELIVERIES], folder / DELIVERIES, Deliveries)
    traces = _decoded(decode_traces, contents, folder / TRACES)
    trials = _decoded(partial(decode_outcomes, traces=traces), contents, folder / OUTCOMES)
    signals = {}
    if SIGNALS in contents:
        signals = _decoded(decode_signals, contents, folder / SIGNALS)
    for doubt in _doubts(record, provenance, shown, trials, deliveries):
        raise UserError(f"the files of {folder} do not belong together ({doubt}): {AGAIN}.")
    return ReportInput(record, provenance, shown, trials, signals)


def _decoded(
    decode: Callable[[bytes], _Table], contents: Mapping[str, bytes], path: Path
) -> _Table:
    try:
        return decode(contents[path.name])
    except Unreadable as error:
        raise UserError(f"{path} is damaged ({error}): {AGAIN}.") from None


def read_provenance(folder: Path) -> RunProvenance:
    """Read how a run was made, with the digests of its files; `UserError` without a sound one."""
    place = folder / "provenance.json"
    return parsed(read_regular(place), place, RunProvenance)


def as_text(record: BaseModel) -> str:
    """Return data as its file holds it."""
    return record.model_dump_json(indent=1) + "\n"


def parsed(data: bytes, path: Path, model: type[_Model]) -> _Model:
    """Return a file's contents as `model`; `UserError` when they are not that."""
    try:
        return model_of(data, model)
    except Misread as error:
        raise UserError(
            f"{path} is damaged or from another version of faultpath ({error}): {AGAIN}."
        ) from None


def _doubts(
    record: AuditResult,
    provenance: RunProvenance,
    shown: SystemShown,
    trials: Trials,
    deliveries: Deliveries,
) -> Iterator[str]:
    """Yield what shows that the files are of different runs, or were put together by hand."""
    question, facts = record.question, record.facts
    if provenance.library_hash != facts.library_hash:
        yield "result and provenance name different libraries"
    if tuple(variant.name for variant in shown.variants) != (question.baseline, question.repair):
        yield "the system's variants are not those of the question"
    if question.metric and question.metric not in facts.metrics:
        yield f"the result shows a metric '{question.metric}' that its system does not declare"
    yield from _other_trials(record, trials)
    yield from _other_effects(record)
    yield from _other_taps(record, shown.interface, deliveries)
    if not set(deliveries.findings) <= set(record.findings):
        yield "the result leaves out a finding of the run"


def _other_trials(record: AuditResult, trials: Trials) -> Iterator[str]:
    """Yield where the record tells of other trials than the outcomes hold."""
    question = record.question
    variants = set(
        product((question.baseline, question.repair), (p.name for p in record.conditions))
    )
    counts = {(of.variant, of.condition): (of.trials, of.success) for of in record.counts}
    rows = {
        variant: trials.rows(*variant).ravel()
        for variant in product(trials.variants, trials.conditions)
    }
    rows = {variant: of[of >= 0] for variant, of in rows.items() if (of >= 0).any()}
    if not variants or set(counts) != variants or set(rows) != variants:
        yield "the result and the outcomes have different versions, conditions or seeds"
        return
    if np.isnan(trials.time_s[~trials.failed]).any() and not record.facts.judged:
        yield "trials of an audit have no time"
    solved = trials.has(Status.SUCCESS)
    if any(counts[variant] != (len(of), int(solved[of].sum())) for variant, of in rows.items()):
        yield "the result and the outcomes count different successes"
    measured = set(trials.metrics)
    names = {name for of in record.secondary for name in of.metrics}
    for name in sorted(names - measured):
        yield f"the result has a metric '{name}', and the outcomes have no such column"


def _other_effects(record: AuditResult) -> Iterator[str]:
    """Yield where effects do not fit the conditions of the record, or each other."""
    conditions = {condition.name for condition in record.conditions}
    results = (*record.effects, *record.break_evens)
    if not conditions.issuperset(result.condition for result in results):
        yield "the result has effects under conditions that it does not name"
    names = [effect.condition for effect in record.effects]
    ends = {condition for change in record.changes for condition in (change.isolated, SHARED)}
    if not ends.issubset(names) or [of.condition for of in record.secondary] != names:
        yield "the result has effects that contradict each other"
    if not all(effect.won for effect in record.effects):
        yield "the result has an effect without its counts"
    significant = [of for of in (*record.effects, *record.changes) if of.sign]
    if any(of.corrected_p is None or of.corrected_p > ALPHA for of in significant):
        yield "the result calls significant what its p-values do not"


def _other_taps(record: AuditResult, interface: Interface, deliveries: Deliveries) -> Iterator[str]:
    """Yield where the record names other faulted taps than interface and delivery log."""
    question = record.question
    taps = {(c.name, reader) for c in interface.channels for reader in c.readers}
    for condition in record.conditions:
        faulted = {
            question.repair: condition.faulted,
            question.baseline: condition.baseline_faulted,
        }
        for variant, named in faulted.items():
            if not taps.issuperset((tap.channel, tap.reader) for tap in named):
                yield "the result names injection points that the interface does not have"
            try:
                received = faulted_taps(deliveries.at(variant, condition.name))
            except KeyError:
                yield "the delivery log leaves out a version or condition of the result"
            else:
                if received != named:
                    yield (
                        "delivery log and result differ in who got the fault under "
                        f"'{condition.name}'"
                    )
