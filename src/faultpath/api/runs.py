"""Finished runs as a program and a notebook use them, read as data: nothing they name is run."""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from importlib.metadata import entry_points
from os import PathLike, fspath
from pathlib import Path
from typing import Any, ClassVar

import pyarrow as pa

from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import AuditResult
from faultpath.analyses.scan.model import ScanResult
from faultpath.api.folders import (
    MADE_FROM,
    MAP_MADE_FROM,
    SCAN_MADE_FROM,
    parsed,
    read_provenance,
    read_run,
)
from faultpath.core.errors import UserError
from faultpath.core.files.atomic import check_output, is_run, write_text
from faultpath.core.files.opening import named_path
from faultpath.core.files.parquet import read_table
from faultpath.report import comparison
from faultpath.report.audit_tables import markdown_table
from faultpath.report.compared import Compared, differing, together
from faultpath.report.frame import PAGE
from faultpath.report.gate import Answer, Ask, found, holds_when_shared
from faultpath.report.html import write_report
from faultpath.report.inputs import ReportInput
from faultpath.report.map import write_map
from faultpath.report.scan import write_scan
from faultpath.report.sentences import Words, words
from faultpath.run.provenance import AGAIN, RunProvenance, unseal
from faultpath.run.store.tables import encode_outcomes
from faultpath.system import declared


class FinishedRun(ABC):
    """A finished run: its result, how it was made, and where its files are."""

    files: ClassVar[tuple[str, ...]] = MADE_FROM
    """Files that its pages are made from, the result first."""

    def __init__(self, folder: Path, record: Any, provenance: RunProvenance) -> None:
        self.folder = folder
        self.record = record
        self.provenance = provenance
        """Record of what ran, on what, with which code, packages and options."""

    @property
    @abstractmethod
    def headline(self) -> str:
        """The result in one sentence."""

    def __repr__(self) -> str:
        """Return kind, folder and headline."""
        return f"<{type(self).__name__} in {self.folder}: {self.headline}>"


class AnalysedRun(FinishedRun):
    """A finished audit, map or scan."""

    @property
    def words(self) -> Words:
        """The result in words: `headline`, `sentences`, `findings`, `would_change` of an audit and
        `commands` of a scan."""
        return words(self.record)

    @property
    def headline(self) -> str:
        """The result in one sentence."""
        return self.words.headline

    @property
    def sentences(self) -> tuple[str, ...]:
        """All that it says, a sentence or two each."""
        return self.words.sentences

    def _place(self, folder: str | PathLike[str] | None) -> Path:
        """Return where pages go, by default the run's folder; `UserError` for another run's."""
        if folder is None:
            return self.folder
        try:
            place = named_path(fspath(folder))
        except ValueError as error:
            raise UserError(f"{error}.") from None
        if is_run(place) and place.resolve() != self.folder.resolve():
            raise UserError(f"{place} holds another run: give another folder.")
        return place


class Run(AnalysedRun):
    """A finished audit: its result, from which trials, and where its files are.

    A notebook shows it as the table of its effects, with the result in words below.
    """

    record: AuditResult
    """Result of the audit in numbers: `effects`, `changes`, ..."""

    def __init__(self, folder: Path, source: ReportInput) -> None:
        super().__init__(folder, source.record, source.provenance)
        self.inputs = source
        """All that its pages are made from."""

    @property
    def failed(self) -> int:
        """Number of trials in which the program raised an error; each voids its pair."""
        return int(self.inputs.trials.failed.sum())

    @property
    def broken(self) -> bool:
        """Whether a trial failed, or no result follows from the trials: a build ends with 1."""
        return bool(self.failed or self.record.invalid)

    @property
    def repair_holds_when_shared(self) -> Answer:
        """Whether the repair is significantly ahead under the shared fault; a failed assert shows
        what was found instead. `UserError` where the audit has no shared fault."""
        return holds_when_shared(self.record)

    def found(self, what: Ask) -> Answer:
        """Return whether `reversal`, `repair-behind`, `undecided` or `void` was found, as
        `--fail-if` asks."""
        return found(self.record, what)

    def table(self) -> pa.Table:
        """Return the trials as an Arrow table, one row each: variant, `condition` (the condition),
        seed, scene, status, time_s, the system's metrics (null where a trial has none), and what
        the injection points did.

        Its `to_pandas` makes a DataFrame where pandas is installed.
        """
        return read_table(encode_outcomes(self.inputs.trials))

    def report(self, folder: str | PathLike[str] | None = None) -> list[Path]:
        """Write report.html and table.md, and return their paths.

        They go into `folder`, by default that of the run. `UserError` where it cannot be written,
        or holds another run.
        """
        return write_report(self.inputs, self._place(folder))

    def _repr_markdown_(self) -> str:
        return markdown_table(self.record)


class MapRun(AnalysedRun):
    """A finished reversal map: its result, and where its files are."""

    files = MAP_MADE_FROM
    record: MapResult
    """Result of the map in numbers: `points`, `surface`, `flips`, `joint`."""

    def report(self, folder: str | PathLike[str] | None = None) -> list[Path]:
        """Write report.html, map.svg, correlation.svg and table.md, and return their paths."""
        return write_map(self.record, self.provenance, self._place(folder))


class ScanRun(AnalysedRun):
    """A finished scan: its result, and where its files are."""

    files = SCAN_MADE_FROM
    record: ScanResult
    """Result of the scan in numbers: `errors`, `versions`, ..."""

    def report(self, folder: str | PathLike[str] | None = None) -> list[Path]:
        """Write report.html, scan.svg and table.md, and return their paths."""
        return write_scan(self.record, self.provenance, self._place(folder))


def open_run(folder: str | PathLike[str]) -> "Run | MapRun | ScanRun | Any":
    """Open the folder of a finished audit, map or scan, one's own or anybody's.

    It is taken for data: no code that it names is run, and every file is compared with its digest.
    What an installed distribution leaves behind is opened by it: an entry point in the group
    `faultpath.runs` names a file of such a folder, and what reads the folder. Raises `UserError`
    for a folder that holds none of them, or a damaged or changed one.
    """
    try:
        place = Path(folder)
    except TypeError:
        shown = declared.shown(folder)
        raise UserError(f"{shown} is no path: give the folder of a finished run.") from None
    provenance = read_provenance(place)
    for kind, model in ((MapRun, MapResult), (ScanRun, ScanResult)):
        if kind.files[0] in provenance.files:
            contents = unseal(place, provenance.files, kind.files)
            record = parsed(contents[kind.files[0]], place / kind.files[0], model)
            if provenance.library_hash != record.facts.library_hash:
                raise UserError(f"the files of {place} do not belong together: {AGAIN}.")
            return kind(place, record, provenance)
    if Run.files[0] not in provenance.files:
        for point in entry_points(group="faultpath.runs"):
            if point.name in provenance.files:
                return point.load()(place)
    return Run(place, read_run(place))


@dataclass(frozen=True, repr=False, eq=False)
class RunComparison:
    """Finished audits side by side."""

    runs: tuple[Compared, ...]
    """Each with its `number`, `folder`, `record` and `provenance`."""

    @property
    def headline(self) -> str:
        """How many audits there are, and where they are significant in opposite directions."""
        return comparison.headline(self.runs)

    def report(self, path: str | PathLike[str]) -> Path:
        """Write one page that needs no network, and return its path.

        `UserError` where it cannot be written, or another file stands.
        """
        check_output(Path(path), PAGE)
        write_text(Path(path), comparison.page(self.runs))
        return Path(path)

    def as_json(self) -> dict[str, object]:
        """Return headline, sentences, what differs, and each result, for `json.dumps`."""
        entries: list[dict[str, object]] = []
        for run in self.runs:
            entry = in_json(run.folder, run.record)
            if run.family is not None:
                entry["over_all_sizes"] = {
                    condition: {"sign": sign, "corrected_p": p}
                    for condition, (sign, p) in run.family.items()
                }
            entries.append(entry)
        return {
            "headline": self.headline,
            "sentences": comparison.sentences(self.runs),
            "differs": differing(self.runs),
            "runs": entries,
        }

    def __repr__(self) -> str:
        return f"<Comparison: {self.headline}>"


def in_json(folder: str | Path, record: AuditResult | MapResult | ScanResult) -> dict[str, object]:
    """Return what `--json` prints of a result, for `json.dumps`: its words, and its numbers."""
    return {
        "folder": str(folder),
        **{name: said for name, said in asdict(words(record)).items() if said is not None},
        "record": record.model_dump(mode="json"),
    }


def compare(runs: Iterable[str | PathLike[str] | Run]) -> RunComparison:
    """Set finished audits side by side: effects by condition, what differs, who disagrees.

    Audits are separate tests and are not compared with each other. Sizes of one fault are one
    family, and only what is significant over all of them is called so.

    Args:
        runs: Two or more finished audits, or their folders; each once.

    Raises:
        UserError: There are fewer than two, one is given twice, or a folder holds no finished
            audit, or one that was changed since.
    """
    sources = [runs] if isinstance(runs, str | PathLike | FinishedRun) else list(runs)
    if len(sources) < 2:
        raise UserError("comparing takes two or more runs: give the folders of finished audits.")
    compared: list[Compared] = []
    places: set[Path] = set()
    for number, source in enumerate(sources, 1):
        run = source if isinstance(source, FinishedRun) else open_run(source)
        if not isinstance(run, Run):
            raise UserError(f"{run.folder} holds no audit: only finished audits can be compared.")
        if run.folder.resolve() in places:
            raise UserError(f"{run.folder} is given twice: give each run once.")
        places.add(run.folder.resolve())
        compared.append(Compared(number, str(run.folder), run.inputs))
    return RunComparison(together(compared))
