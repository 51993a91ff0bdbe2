"""Marked blocks of the documents about reference runs of `faultpath map`."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from blocks import REFERENCE, TAKE_AGAIN, about, command, copied, parsed, printed
from flown_code import flown_by
from pictures import IMAGES

from faultpath.api.folders import MAP
from faultpath.api.folders import MAP_MADE_FROM as MADE_FROM
from faultpath.decisions.map.model import MapRecord
from faultpath.decisions.tables.markdown import grid
from faultpath.report.map import shown, table_markdown, tables
from faultpath.report.map_pictures import correlation_picture, map_picture
from faultpath.trials.provenance import RunProvenance

TAKEN = (*MADE_FROM, "provenance.json")
PICTURES = {"map": map_picture, "correlation": correlation_picture}


@dataclass(frozen=True)
class Mapped:
    """A reference map."""

    name: str
    record: MapRecord
    provenance: RunProvenance


@cache
def load(name: str) -> Mapped:
    """Return a reference map; `Wrong` for a damaged one, and where there is none."""
    folder = REFERENCE / name
    record = parsed(folder / MAP, MapRecord, TAKE_AGAIN)
    return Mapped(name, record, parsed(folder / "provenance.json", RunProvenance, TAKE_AGAIN))


def take(name: str, folder: Path) -> None:
    """Make the folder of a map a reference map."""
    copied(TAKEN, folder, REFERENCE / name)
    load.cache_clear()
    (REFERENCE / name / "table.md").write_text(table_markdown(load(name).record), "utf-8")


def pictures() -> Mapping[Path, str]:
    """Return the pictures of all reference maps, by their path."""
    names = sorted(path.parent.name for path in REFERENCE.glob(f"*/{MAP}"))
    return {
        IMAGES / f"{run.name}-{part}.svg": draw(run.record).render(standalone=True) + "\n"
        for run in map(load, names)
        for part, draw in PICTURES.items()
    }


def _terminal(run: Mapped) -> str:
    return printed(shown(run.record))


def _picture(run: Mapped, part: str) -> str:
    return f"![{run.record.headline}]({{images}}/{run.name}-{part}.svg)"


def _said(run: Mapped) -> str:
    record, question = run.record, run.record.question
    lines = [f"> **{record.headline}**"]
    lines += [f"> {sentence}" for sentence in record.sentences]
    flown = flown_by(run.provenance, question.system, question.options)
    return "\n>\n".join(lines) + f"\n\n{flown}"


def _turns(run: Mapped) -> str:
    flips = next(table for table in tables(run.record) if table.name == "flips")
    return "\n\n".join([grid(flips), *flips.notes])


KIND = dict(about(load, command, _terminal, _picture, _said, _turns))
"""Functions that fill the blocks about maps, by kind."""
