"""Finished runs as a program and a notebook use them, read as data: nothing they name is run."""

import json
import math
from collections import Counter
from importlib.metadata import entry_points
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import pyarrow as pa
from pydantic import BaseModel

from faultpath.core.errors import UserError
from faultpath.core.files.parquet import Unreadable, read_table
from faultpath.core.files.plain import Misread, model_of
from faultpath.core.renamed import tells_renames
from faultpath.decisions.gate import Answer, Ask, found, holds_when_shared
from faultpath.decisions.model import DecisionRecord
from faultpath.decisions.planning import faulted_taps
from faultpath.report.html import write_report
from faultpath.report.inputs import ReportInput, Traces
from faultpath.report.tables import markdown_table
from faultpath.trials import Deliveries, OutcomeTable, Status, SystemShown
from faultpath.trials.provenance import RunProvenance
from faultpath.trials.store.folder import AGAIN, DELIVERIES, OUTCOMES, TRACES, read_regular, unseal
from faultpath.trials.store.signals import SIGNALS, decode_signals
from faultpath.trials.store.tables import decode_outcomes, decode_traces

if TYPE_CHECKING:
    from faultpath.decisions.map.model import MapRecord
    from faultpath.decisions.search.model import SearchRecord
    from faultpath.decisions.sensitivity.model import SensitivityRecord

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


class FinishedRun:
    """A finished run: what was decided, how it was made, and where its files are."""

    def __init__(self, folder: Path, record: Any, provenance: RunProvenance) -> None:
        self.folder = folder
        self.record = record
        self.provenance = provenance
        """What ran, on what, with which code, packages and options."""

    @property
    def headline(self) -> str:
        """What was decided, in one sentence."""
        return self.record.headline

    def __repr__(self) -> str:
        """Return kind, folder and headline."""
        return f"<{type(self).__name__} in {self.folder}: {self.headline}>"


@tells_renames
class Run(FinishedRun):
    """A finished audit: what was decided, from which trials, and where its files are.

    A notebook shows it as the table of its effects, with the verdict below.
    """

    record: DecisionRecord
    """What was decided: `headline` in a sentence, `effects` in numbers."""

    def __init__(self, folder: Path, held: ReportInput, trials: pa.Table) -> None:
        super().__init__(folder, held.record, held.provenance)
        self.held = held
        """All that its pages are made from."""
        self._trials = trials

    @property
    def headline(self) -> str:
        """The verdict in one sentence."""
        return self.record.headline

    @property
    def failed(self) -> int:
        """Number of trials in which the program raised an error; each voids its pair."""
        return self._trials.column("status").to_pylist().count(Status.FAILED.value)

    @property
    def repair_holds_when_shared(self) -> Answer:
        """Whether the repair is decided to be ahead under the shared fault; a failed assert shows
        what was decided instead. `UserError` where the audit has no shared fault."""
        return holds_when_shared(self.record)

    def found(self, what: Ask) -> Answer:
        """Return whether `reversal`, `repair-behind`, `undecided` or `void` was found, as
        `--fail-if` asks."""
        return found(self.record, what)

    def table(self) -> pa.Table:
        """Return the trials as an Arrow table, one row each: variant, path, seed, scene, status,
        time_s, the system's metrics (null where a trial has none), and what the taps did.

        Its `to_pandas` makes a DataFrame where pandas is installed.
        """
        return self._trials

    def report(self, folder: str | PathLike[str] | None = None) -> list[Path]:
        """Write report.html and table.md, and return their paths.

        They go into `folder`, by default that of the run. `UserError` where it cannot be written.
        """
        return write_report(self.held, self.folder if folder is None else Path(folder))

    def _repr_markdown_(self) -> str:
        return markdown_table(self.record)


class MapRun(FinishedRun):
    """A finished reversal map: what was decided, and where its files are."""

    record: "MapRecord"
    """`headline` and `sentences` in words; `points`, `surface`, `flips`, `joint` in numbers."""

    def report(self, folder: str | PathLike[str] | None = None) -> list[Path]:
        """Write report.html, map.svg, correlation.svg and table.md, and return their paths."""
        from faultpath.report.map import write_map

        place = self.folder if folder is None else Path(folder)
        return write_map(self.record, self.provenance, place)


class SearchRun(FinishedRun):
    """A finished search: what was confirmed, and where its files are."""

    record: "SearchRecord"
    """`headline` and `sentences` in words; `tried`, and `confirmed`, the record of the audit."""

    def report(self, folder: str | PathLike[str] | None = None) -> list[Path]:
        """Write report.html, tried.svg and table.md, and return their paths."""
        from faultpath.report.search import write_search

        place = self.folder if folder is None else Path(folder)
        return write_search(self.record, self.provenance, place)


class SensitivityRun(FinishedRun):
    """A finished sensitivity analysis: what was decided, and where its files are."""

    record: "SensitivityRecord"
    """`headline` and `sentences` in words; `indices` in numbers, a group each."""

    def report(self, folder: str | PathLike[str] | None = None) -> list[Path]:
        """Write report.html, sensitivity.svg, sensitivity.csv and table.md; return their paths."""
        from faultpath.report.sensitivity import write_sensitivity

        place = self.folder if folder is None else Path(folder)
        return write_sensitivity(self.record, self.provenance, place)


def open_run(folder: str | PathLike[str]) -> "Run | MapRun | SearchRun | SensitivityRun | Any":
    """Open the folder of a finished audit, map, search or sensitivity analysis, one's own or
    anybody's.

    It is taken for data: no code that it names is run, and every file is compared with its digest.
    What an installed distribution leaves behind is opened by it: an entry point in the group
    `faultpath.runs` names a file of such a folder, and what reads the folder. Raises `UserError`
    for a folder that holds none of them, or a damaged or changed one.
    """
    place = Path(folder)
    provenance = read_provenance(place)
    for name, made_from, kind in (
        (MAP, MAP_MADE_FROM, MapRun),
        (SEARCH, SEARCH_MADE_FROM, SearchRun),
        (SENSITIVITY, SENSITIVITY_MADE_FROM, SensitivityRun),
    ):
        if name not in provenance.files:
            continue
        from faultpath.decisions.map.model import MapRecord
        from faultpath.decisions.search.model import SearchRecord
        from faultpath.decisions.sensitivity.model import SensitivityRecord

        held = unseal(place, provenance.files, made_from)
        models = {MapRun: MapRecord, SearchRun: SearchRecord, SensitivityRun: SensitivityRecord}
        record = parsed(held[name], place / name, models[kind])
        if (provenance.files[OUTCOMES], provenance.library_hash) != (
            provenance.outcomes_sha256,
            record.question.library_hash,
        ):
            raise UserError(f"the files of {place} do not belong together: {AGAIN}.")
        return kind(place, record, provenance)
    if RECORD not in provenance.files:
        for point in entry_points(group="faultpath.runs"):
            if point.name in provenance.files:
                return point.load()(place)
    return Run(place, *read_run(place))


def read_run(folder: Path) -> tuple[ReportInput, pa.Table]:
    """Read all that the pages of an audit are made from, and its trials as an Arrow table.

    Every file is compared with the digest in `provenance.json` first. `UserError` for a file that
    is missing, damaged or changed, and for files that do not belong together.
    """
    provenance = read_provenance(folder)
    held = unseal(folder, provenance.files, MADE_FROM)
    record = parsed(held[RECORD], folder / RECORD, DecisionRecord)
    shown = parsed(held[SYSTEM], folder / SYSTEM, SystemShown)
    deliveries = parsed(held[DELIVERIES], folder / DELIVERIES, Deliveries)
    decoders = {OUTCOMES: decode_outcomes, TRACES: decode_traces, SIGNALS: decode_signals}
    tables: dict[str, Any] = {SIGNALS: {}}
    for name, decode in decoders.items():
        if name in held:
            try:
                tables[name] = decode(held[name])
            except Unreadable as error:
                raise UserError(f"{folder / name} is damaged ({error}): {AGAIN}.") from None
    outcomes = tables[OUTCOMES]
    doubt = _doubt(record, provenance, shown, outcomes, deliveries)
    if doubt:
        raise UserError(f"the files of {folder} do not belong together ({doubt}): {AGAIN}.")
    read = ReportInput(
        record=record,
        provenance=provenance,
        interface=shown.interface,
        variants=shown.variants,
        outcomes=outcomes,
        traces=Traces(tables[TRACES], shown.control_dt_s),
        plans=shown.plans,
        signals=tables[SIGNALS],
    )
    return read, read_table(held[OUTCOMES])


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
    ended = (row.outcome for row in outcomes.rows if not row.outcome.failed)
    untimed = any(math.isnan(each.time_s) for each in ended)
    if untimed and asked.judged is None:
        return "trials of an audit have no time"
    if any(cells[at].trials != trials[at] or cells[at].success != solved[at] for at in wanted):
        return "the record and the outcomes count different successes"
    measured = {name for row in outcomes.rows for name in row.outcome.metrics}
    for effect in record.effects:
        if lost := sorted(set(effect.metrics) - measured):
            return f"the record tells of '{lost[0]}', and the outcomes have no such column"
    if not paths.issuperset(each.path for each in (*record.effects, *record.break_even)):
        return "the record has effects on paths that it does not name"
    taps = {(c.name, consumer) for c in shown.interface.channels for consumer in c.consumers}
    for path in record.paths:
        faulted = {asked.repair: path.faulted, asked.baseline: path.baseline_faulted}
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
