"""What the documents show of reference runs of `faultpath map`."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

from blocks import REFERENCE, ROOT, TAKE_AGAIN, command, copied, fence, missing, parsed
from flown_code import flown_by
from pictures import IMAGES
from rich.console import Console

from faultpath.api.runs import MAP
from faultpath.api.runs import MAP_MADE_FROM as MADE_FROM
from faultpath.decisions.map.decide import conclude as decide
from faultpath.decisions.map.lattice import UNITS
from faultpath.decisions.map.model import MapRecord
from faultpath.decisions.map.study import plan_map
from faultpath.decisions.tables.markdown import grid
from faultpath.report.map import shown, table_markdown, tables
from faultpath.report.map_pictures import correlation_picture, map_picture
from faultpath.trials import SystemSpec, library_of, load_system
from faultpath.trials.provenance import RunProvenance
from faultpath.trials.question import MapQuestion
from faultpath.trials.store.folder import OUTCOMES, read_outcomes, seal

TAKEN = (*MADE_FROM, "provenance.json")
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
    if (run := load(name)) is not None:
        (REFERENCE / name / "table.md").write_text(table_markdown(run.record), "utf-8")


def conclude(folder: Path) -> MapRecord:
    """Decide a reference map anew from its trials; write its record and table."""
    before = parsed(folder / MAP, MapRecord, TAKE_AGAIN)
    asked = before.question
    place = str(ROOT / asked.system) if ".py:" in asked.system else asked.system
    spec = SystemSpec(name=place, options=asked.options)
    system = load_system(spec)
    request = MapQuestion(
        baseline=asked.baseline,
        repair=asked.repair,
        fault=asked.fault,
        against=asked.against,
        up_to=asked.up_to,
        points=asked.points,
        mean=asked.means,
        spread=asked.spreads,
        correlation=asked.correlation,
        scenes=asked.n_scenes,
        seeds=asked.seeds,
    )
    plan = plan_map(system, spec, request, library_of(system, asked.library))
    plan = replace(plan, question=asked)
    flown = [
        [round(error / asked.up_to * UNITS) for error in each.errors] for each in before.points
    ]
    outcomes = read_outcomes(folder / OUTCOMES)
    record = decide(plan, [(x, y) for x, y in flown], outcomes, before.findings)
    (folder / MAP).write_text(record.model_dump_json(indent=1) + "\n", "utf-8")
    (folder / "table.md").write_text(table_markdown(record), "utf-8")
    origin = parsed(folder / "provenance.json", RunProvenance, TAKE_AGAIN)
    sealed = origin.model_copy(update={"files": seal(folder, origin.files)})
    (folder / "provenance.json").write_text(sealed.model_dump_json(indent=2) + "\n", "utf-8")
    load.cache_clear()
    return record


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
    return f"![{run.record.headline}]({{images}}/{run.name}-{part}.svg)"


def _said(run: Mapped) -> str:
    record, asked = run.record, run.record.question
    lines = [f"> **{record.headline}**"]
    lines += [f"> {each}" for each in record.sentences]
    flown = flown_by(run.provenance, asked.system, asked.options)
    return "\n>\n".join(lines) + f"\n\n{flown}"


def _turns(run: Mapped) -> str:
    flips = next(each for each in tables(run.record) if each.name == "flips")
    return "\n\n".join([grid(flips), *flips.notes])


def _about(fill: Callable[..., str], *, first: bool = False) -> Callable[..., str]:
    def filled(name: str, *arguments: str) -> str:
        run: Any = load(name)
        if run is None:
            return missing(name) if first else ""
        return fill(run, *arguments)

    return filled


KIND: dict[str, Callable[..., str]] = {
    "command": _about(command, first=True),
    "terminal": _about(_terminal),
    "picture": _about(_picture),
    "said": _about(_said),
    "turns": _about(_turns),
}
"""What fills the kinds of blocks about maps."""
