"""What the documents show of reference runs of `faultpath map`, and of its self-check."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

from blocks import REFERENCE, TAKE_AGAIN, command, copied, fence, missing, parsed
from pictures import IMAGES
from rich.console import Console

from faultpath.door.map_flying import MADE_FROM
from faultpath.door.saved import MAP
from faultpath.plane.model import MapRecord
from faultpath.record import RunProvenance
from faultpath.report import wording
from faultpath.report.figures.plane import correlation_picture, map_picture
from faultpath.report.plane import shown
from faultpath.selfcheck import Report, failures
from faultpath.selfcheck.words import tables
from faultpath.tables.markdown import grid

TAKEN = (*MADE_FROM, "provenance.json", "table.md")
CHECK = REFERENCE / "map-check.json"
PICTURES = {"map": map_picture, "correlation": correlation_picture}


@dataclass(frozen=True)
class Mapped:
    """A reference map."""

    name: str
    record: MapRecord
    provenance: RunProvenance


@cache
def load(name: str) -> Mapped | None:
    """Return a reference map, `None` where there is none; `Wrong` for a damaged one."""
    folder = REFERENCE / name
    if not (folder / MAP).is_file():
        return None
    record = parsed(folder / MAP, MapRecord, TAKE_AGAIN)
    return Mapped(name, record, parsed(folder / "provenance.json", RunProvenance, TAKE_AGAIN))


def take(name: str, folder: Path) -> None:
    """Make the folder of a map a reference map."""
    copied(TAKEN, folder, REFERENCE / name)
    load.cache_clear()


def pictures() -> Mapping[Path, str]:
    """Return the pictures of all reference maps, by their path."""
    names = sorted(path.parent.name for path in REFERENCE.glob(f"*/{MAP}"))
    return {
        IMAGES / f"{run.name}-{part}.svg": draw(run.record).render(standalone=True) + "\n"
        for run in map(load, names)
        if run is not None
        for part, draw in PICTURES.items()
    }


def _terminal(run: Mapped) -> str:
    console = Console(file=StringIO(), width=100, record=True, color_system=None)
    console.print(shown(run.record))
    lines = (line.rstrip() for line in console.export_text().splitlines())
    return fence("text", "\n".join(lines).strip("\n"))


def _picture(run: Mapped, part: str) -> str:
    return f"![{wording.typeset(run.record.headline)}]({{images}}/{run.name}-{part}.svg)"


def _check() -> str:
    if not CHECK.is_file():
        return (
            f"*`faultpath selfcheck map --out docs/reference/{CHECK.name}` has not been run yet.*"
        )
    report = parsed(CHECK, Report, "run faultpath selfcheck map again")
    broken = failures(report)
    said = "\n".join(f"- {each}" for each in broken)
    kept = f"Promises broken:\n\n{said}" if said else "No promise is broken beyond three errors."
    shown_ = [f"**{table.title}**\n\n{table.notes[0]}\n\n{grid(table)}" for table in tables(report)]
    return "\n\n".join([kept, *shown_])


def _about(fill: Callable[..., str]) -> Callable[..., str]:
    def filled(name: str, *arguments: str) -> str:
        run: Any = load(name)
        return missing(name) if run is None else fill(run, *arguments)

    return filled


KIND: dict[str, Callable[..., str]] = {
    "command": _about(command),
    "terminal": _about(_terminal),
    "picture": _about(_picture),
    "check": _check,
}
"""What fills the kinds of blocks about maps."""
