"""`faultpath.compare`: several finished audits side by side."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from os import PathLike
from pathlib import Path

from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import AuditResult
from faultpath.analyses.scan.model import ScanResult
from faultpath.api.runs import Run, open_run
from faultpath.core.errors import UserError
from faultpath.core.files.atomic import check_output, write_text
from faultpath.report.compared import Compared, differing, together
from faultpath.report.comparison import headline, page, sentences
from faultpath.report.frame import PAGE
from faultpath.report.sentences import words


@dataclass(frozen=True, repr=False, eq=False)
class RunComparison:
    """Finished audits side by side."""

    runs: tuple[Compared, ...]
    """Each with its `number`, `folder`, `record` and `provenance`."""

    @property
    def headline(self) -> str:
        """How many audits there are, and where they are significant in opposite directions."""
        return headline(self.runs)

    def report(self, path: str | PathLike[str]) -> Path:
        """Write one page that needs no network, and return its path.

        `UserError` where it cannot be written, or another file stands.
        """
        check_output(Path(path), PAGE)
        write_text(Path(path), page(self.runs))
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
            "sentences": sentences(self.runs),
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


def compare(runs: Sequence[str | PathLike[str] | Run]) -> RunComparison:
    """Set finished audits side by side: effects by condition, what differs, who disagrees.

    Audits are separate tests and are not compared with each other. Sizes of one fault are one
    family, and only what is significant over all of them is called so.

    Args:
        runs: Two or more finished audits, or their folders; each once.

    Raises:
        UserError: There are fewer than two, one is given twice, or a folder holds no finished
            audit, or one that was changed since.
    """
    if isinstance(runs, str | PathLike) or len(runs) < 2:
        raise UserError("comparing takes two or more runs: give the folders of finished audits.")
    compared: list[Compared] = []
    places: set[Path] = set()
    for number, source in enumerate(runs, 1):
        run = source if isinstance(source, Run) else open_run(source)
        if not isinstance(run, Run):
            raise UserError(f"{run.folder} holds no audit: only finished audits can be compared.")
        if run.folder.resolve() in places:
            raise UserError(f"{run.folder} is given twice: give each run once.")
        places.add(run.folder.resolve())
        compared.append(Compared(number, str(run.folder), run.inputs))
    return RunComparison(together(compared))
