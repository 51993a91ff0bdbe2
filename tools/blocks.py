"""Stored runs and studies that documents take their numbers from."""

import json
import shutil
import sys
from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import BaseModel, ValidationError

from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import AuditResult
from faultpath.analyses.scan.model import ScanResult
from faultpath.api.folders import (
    MADE_FROM,
    MAP,
    MAP_MADE_FROM,
    OUTCOMES,
    RECORD,
    SCAN,
    SCAN_MADE_FROM,
)
from faultpath.report.escapes import html as escape
from faultpath.report.sentences import words
from faultpath.run.provenance import RunProvenance

sys.path += [
    str(Path(__file__).resolve().parents[1] / "experiments" / study)
    for study in ("carry-over", "state-errors")
]
from carry_design import Flown
from state_design import SensorAudits

ROOT = Path(__file__).resolve().parents[1]
REFERENCE = ROOT / "docs" / "reference"
IMAGES = ROOT / "docs" / "images"
PROVENANCE, CELLS, AUDITS = "provenance.json", "cells.json", "audits.json"
REPEATS = "repeats.json"
"""Result of repeating a sample of a run's trials, which `tools/references.py` writes."""
RUNS: dict[str, tuple[type[BaseModel], tuple[str, ...]]] = {
    RECORD: (AuditResult, (*MADE_FROM, PROVENANCE, "report.html", "table.md")),
    MAP: (MapResult, (*MAP_MADE_FROM, PROVENANCE, "table.md")),
    SCAN: (ScanResult, (*SCAN_MADE_FROM, PROVENANCE, "report.html", "table.md")),
    CELLS: (Flown, (CELLS, PROVENANCE)),
    AUDITS: (SensorAudits, (AUDITS, OUTCOMES, PROVENANCE)),
}
"""Kinds of reference runs, by the file of their record: its model, and the files that are kept."""


class Wrong(Exception):
    """A mistake that the editor of the documents has to correct."""


class Picture(NamedTuple):
    """A picture that follows from numbers: name of its file, its text for readers, content."""

    name: str
    text: str
    svg: str
    still: str = ""
    """What a film shows to readers who prefer no motion."""
    caption: str = ""

    @property
    def files(self) -> dict[Path, str]:
        """What its files hold, by their path."""
        files = {IMAGES / self.name: self.svg, IMAGES / self._name_of_still: self.still}
        return {path: content for path, content in files.items() if content}

    @property
    def shown(self) -> str:
        """What a document shows of it."""
        if not self.still:
            return f"![{self.text}]({{images}}/{self.name})"
        still = (
            f'media="(prefers-reduced-motion: reduce)" srcset="{{images}}/{self._name_of_still}"'
        )
        image = f'<img alt="{escape(self.text)}" src="{{images}}/{self.name}">'
        return f"<picture>\n<source {still}>\n{image}\n</picture>\n\n*{self.caption}*"

    @property
    def _name_of_still(self) -> str:
        return self.name.replace(".svg", "-still.svg")


class Repeats(BaseModel):
    """How many of a run's trials came out as they did, run by the code that is here."""

    trials: int
    """All trials of the run."""
    sampled: int
    repeated: int
    """To the bit."""
    near: int
    """With the same end, and numbers within a thousandth; those repeated to the bit included."""
    first: str = ""
    """The first trial that was not repeated to the bit, and in what it differs."""

    @property
    def current(self) -> bool:
        """Whether all were repeated, to the bit or nearly."""
        return self.near == self.sampled > 0

    def __str__(self) -> str:
        count = "all" if self.repeated == self.sampled else f"{self.repeated} of"
        if self.current:
            rest = "" if count == "all" else ", the others within a thousandth"
            return (
                f"{count} {self.sampled} sampled of its {self.trials} trials repeated to the bit "
                f"by this version{rest}"
            )
        lost = self.sampled - self.near
        return (
            f"this version gives other results in {lost} of {self.sampled} sampled of its "
            f"{self.trials} trials"
        )


@dataclass(frozen=True)
class Run:
    """A stored run."""

    name: str
    record: Any
    provenance: RunProvenance

    @property
    def headline(self) -> str:
        """The result in one sentence."""
        return words(self.record).headline

    @property
    def sentences(self) -> tuple[str, ...]:
        """All that the result says."""
        return words(self.record).sentences

    @property
    def repeats(self) -> Repeats | None:
        """Result of repeating some of its trials; `None` where that was not tried yet."""
        path = REFERENCE / self.name / REPEATS
        return parsed(path, Repeats) if path.is_file() else None

    @property
    def flown(self) -> str:
        """By which version it was run, and how many of its trials the code that is here repeats."""
        code, repeats = self.provenance.code, self.repeats
        commit = f" (`{code.commit[:12]}`)" if code.commit else ""
        text = f"Run by faultpath {code.faultpath_version}{commit}"
        return f"{text}; {repeats}." if repeats else f"{text}."

    @property
    def processor(self) -> str:
        """On which processor it was flown."""
        return self.provenance.machine.processor.replace("(R)", "")


def kind_of(folder: Path) -> str:
    """Return the name of the record in a run folder; that of an audit where there is none."""
    return next((file for file in RUNS if (folder / file).is_file()), RECORD)


@cache
def load(name: str) -> Run:
    """Return a reference run; `Wrong` for a damaged one, and where there is none."""
    folder = REFERENCE / name
    file = kind_of(folder)
    return read_run(name, folder / file, RUNS[file][0])


def read_run(name: str, record: Path, model: type[BaseModel]) -> Run:
    """Return the run whose record is a file of its folder; `Wrong` for a damaged one."""
    content = parsed(record, model)
    return Run(name, content, parsed(record.with_name(PROVENANCE), RunProvenance))


def parsed(path: Path, model: type[BaseModel], remedy: str = "take the run again") -> Any:
    """Return the model in a file; `Wrong` where it cannot be read, with the remedy."""
    try:
        return model.model_validate_json(path.read_bytes())
    except (OSError, ValidationError) as error:
        reason = "missing" if isinstance(error, OSError) else f"of another version ({error})"
        raise Wrong(f"{path} is {reason}: {remedy}") from None


def copied(files: Collection[str], folder: Path, target: Path) -> None:
    """Copy files of a finished run; `Wrong` where it has not got them all."""
    if absent := [file for file in files if not (folder / file).is_file()]:
        raise Wrong(f"{folder} holds no finished run: it has no {', '.join(absent)}")
    target.mkdir(parents=True, exist_ok=True)
    for file in files:
        shutil.copyfile(folder / file, target / file)


def figures_of(study: str, file: str) -> Any:
    """Return the numbers that a study of `experiments` left in a JSON file."""
    path = ROOT / "experiments" / study / file
    if not path.is_file():
        raise Wrong(f"{path.relative_to(ROOT)} is missing: {study}/README.md says how it was made")
    return json.loads(path.read_text("utf-8"))
