"""Reference runs of `faultpath audit`, `map` and `scan`, and example files, for their templates."""

import json
import re
import shlex
from collections.abc import Iterator
from io import StringIO
from pathlib import Path
from typing import Any

from blocks import ROOT, Picture, Run, Wrong, load
from faultpath_quadrotor.models import shipped_folder
from faultpath_quadrotor.training.catalogue import ALL, ModelEntry
from rich.console import Console

from faultpath.analyses.model import AuditResult
from faultpath.report.audit_tables import DIFFERENCE, by_quantity
from faultpath.report.map import correlation_picture, map_picture
from faultpath.report.scan_pictures import triangle
from faultpath.report.sentences import words
from faultpath.report.tables import markdown_grid
from faultpath.report.terminal import decision

MAP_PICTURES = {"map": map_picture, "correlation": correlation_picture}
ALTERNATIVES = {"correlation": "The expected difference by the correlation of the two errors"}
"""Descriptions of pictures of a map that show another thing than its headline says."""
PARTS: dict[str, tuple[str, str]] = {
    "interface": ("Who gets the fault", "#interface > *"),
    "effects": ("Effects of the repair", "#effects"),
    "flights": ("Some trials", "#flights > *"),
}
"""Parts of a report that may be pictured: name in words, and selector in the page."""


MEASURES = {
    "position_error_20_m": "position after 20 steps, m",
    "wind_rmse_mps": "wind, m/s",
    "error_m": "clearance, m",
}
"""Errors on held-out windows that a model's card may have, with their names in words."""


def quantities(record: AuditResult) -> str:
    """Return success of both variants and their difference, one condition a column."""
    return markdown_grid(by_quantity(record, ("baseline", "repair", *DIFFERENCE, "holm")))


def printed(name: str) -> str:
    """Return an audit as a terminal of 100 columns prints it."""
    console = Console(file=StringIO(), width=100, record=True, color_system=None)
    console.print(decision(load(name).record))
    lines = (line.rstrip() for line in console.export_text().splitlines())
    return "\n".join(lines).strip("\n")


def command(name: str) -> str:
    """Return the command that made the run; where the run goes is left out."""
    arguments = list(load(name).provenance.command)
    if "--out" in arguments:
        at = arguments.index("--out")
        del arguments[at : at + 2]
    text = shlex.join([Path(arguments[0]).name, *arguments[1:]])
    return "$ " + text.replace(" --", " \\\n    --")


def trials(run: Run) -> int:
    """Return the trials flown: a treatment that a fault cannot reach is that under correct
    inputs."""
    conditions, question = run.record.conditions, run.record.question
    treatments = {("repair", condition.readers) for condition in conditions}
    treatments |= {("baseline", condition.baseline_readers) for condition in conditions}
    return len(treatments) * run.record.facts.n_scenes * len(question.seeds)


def duration(run: Run) -> str:
    """Return the wall time of a run; `Wrong` for one that resumed and did not do it all."""
    if run.provenance.blocks_kept:
        raise Wrong(
            f"docs/reference/{run.name} kept {run.provenance.blocks_kept} blocks of an earlier "
            "invocation, so its wall time is not that of the run; run it in a new folder"
        )
    minutes, seconds = divmod(round(run.provenance.wall_s), 60)
    return f"{minutes} min {seconds:02d} s" if minutes else f"{seconds} s"


def map_picture_of(name: str, part: str) -> Picture:
    """Return the picture of a map, or of its success by correlation."""
    record = load(name).record
    svg = MAP_PICTURES[part](record).render(standalone=True) + "\n"
    text = ALTERNATIVES.get(part) or words(record).headline
    return Picture(f"{name}-{part}.svg", text, svg)


def scan_picture_of(name: str) -> Picture:
    """Return the triangle of pairs of the first variant of a scan."""
    record = load(name).record
    svg = triangle(record, record.versions[0]).render(standalone=True) + "\n"
    text = "Success with none, each and both of the errors of every pair"  # beside the headline
    return Picture(f"{name}-pairs.svg", text, svg)


def part_of(place: str, part: str) -> str:
    """Return a file's part below the line `# --- PART ---`."""
    pieces = re.split(r"^ *# --- (.+) ---\n", (ROOT / place).read_text("utf-8"), flags=re.MULTILINE)
    parts = dict(zip(pieces[1::2], pieces[2::2], strict=True))
    if part not in parts:
        raise Wrong(f"{place} has no part '{part}'; it has {', '.join(parts)}")
    return parts[part].rstrip().strip("\n")


def started(kind: str, name: str, parts: tuple[str, ...]) -> str:
    """Return the file that `faultpath init NAME --with KIND` writes, or parts of it.

    A part is a function, by its name; `imports` is what stands above the first one.
    """
    folder = ROOT / "src" / "faultpath" / "system" / "templates"
    text = (folder / f"{kind}.py.txt").read_text("utf-8").replace("NAME", name).rstrip()
    if not parts:
        return text
    head, *functions = text.split("\n\n\n")
    pieces = {"imports": head} | {
        re.findall(r"^def (\w+)", function, re.MULTILINE)[0]: function for function in functions
    }
    if unknown := [part for part in parts if part not in pieces]:
        raise Wrong(f"template {kind} has no part '{unknown[0]}'; it has {', '.join(pieces)}")
    return "\n\n\n".join(pieces[part] for part in parts)


def models() -> Iterator[tuple[ModelEntry, list[dict[str, Any]]]]:
    """Yield every model that ships with the cards of its fits, seed by seed."""
    for entry in ALL:
        files = [shipped_folder() / f"{entry.name}-{seed}.json" for seed in entry.seeds]
        if missing := [file.stem for file in files if not file.is_file()]:
            raise Wrong(f"{missing[0]} has no card: fit it with make train and ship it")
        yield entry, [json.loads(file.read_text("utf-8")) for file in files]
