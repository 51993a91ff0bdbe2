"""Blocks about reference runs of `faultpath audit`, `map` and `scan`, and about example files."""

import re
import shlex
from pathlib import Path

from blocks import (
    ROOT,
    Picture,
    Run,
    Wrong,
    difference,
    fence,
    figures_of,
    load,
    pipes,
    printed,
)

from faultpath.analyses.effects import Difference
from faultpath.analyses.sentences import phrases, wording
from faultpath.analyses.tables import Table, line
from faultpath.analyses.tables.markdown import grid
from faultpath.report.map_pictures import correlation_picture, map_picture
from faultpath.report.scan_pictures import triangle
from faultpath.report.tables import DIFFERENCE, by_quantity
from faultpath.report.terminal import decision

MAP_PICTURES = {"map": map_picture, "correlation": correlation_picture}
PARTS: dict[str, tuple[str, str]] = {
    "interface": ("Who gets the fault", "#interface > *"),
    "effects": ("Effects of the repair", "#effects"),
    "flights": ("Some trials", "#flights > *"),
}
"""Parts of a report that may be pictured: name in words, and selector in the page."""


def table(name: str) -> str:
    """Return success of both variants and their difference, one condition a column."""
    run = load(name)
    record, question = run.record, run.record.question
    table = by_quantity(record, ("baseline", "repair", *DIFFERENCE, "holm", "break-even"))
    tests = f" Tests: {question.tests}." if question.tests else ""
    return "\n\n".join(
        [
            grid(table),
            f"{question.n_scenes} scenes of `{question.library}`, {wording.seeds(question.seeds)}, "
            f"fault `{question.fault}`. Bold: significant after Holm's correction for "
            f"{record.hypotheses} contrasts. [What each row says]({{docs}}/reading-a-report.md). "
            f"Intervals are for "
            f"{phrases.estimand(question)}. Void pairs: "
            f"{sum(effect.void for effect in record.effects)}.{tests} {run.flown}",
        ]
    )


def headline(name: str) -> str:
    """Return the record's headline as a quotation."""
    return f"> **{load(name).record.headline}**"


def contrast(name: str) -> str:
    """Return the effect at the module whose change to the shared fault is largest, that under the
    shared fault, and the change."""
    run = load(name)
    question, effects = run.record.question, {e.condition: e for e in run.record.effects}
    moved = max(run.record.changes, key=lambda change: abs(change.value))
    if not moved.significant:
        raise Wrong(f"{run.name} has no significant change: the block cannot be filled")
    ahead = {1: f"`{question.repair}`", -1: f"`{question.baseline}`", 0: "neither significantly"}
    places = {
        f"the {moved.isolated} alone, as in a test of one module": effects[moved.isolated],
        "every module that reads the estimate, as in deployment": effects["shared"],
    }
    rows = [(place, _pp(effect), ahead[effect.sign]) for place, effect in places.items()]
    rows.append(("change from the one to the other", _pp(moved), ""))
    minus = f"success of `{question.repair}` minus `{question.baseline}`, pp"
    return (
        f"{pipes(('The fault reaches', minus, 'ahead'), rows, words=(0, 2))}\n\n"
        f"{run.record.scenes} scenes, {wording.seeds(question.seeds)}; pp: percentage points; "
        f"bold: significant at 5 % after Holm's correction. {run.flown}"
    )


def _pp(of: Difference) -> str:
    return difference(of.value, *(of.interval or ()), bold=of.significant)


def terminal(name: str) -> str:
    """Return an audit as the command line prints it, and by which code it was flown."""
    run = load(name)
    return f"{printed(decision(run.record))}\n\n{run.flown}"


def command(name: str, *words: str) -> str:
    """Return the command that made the run, where it goes left out; `words` follow the fence."""
    arguments = list(load(name).provenance.command)
    if "--out" in arguments:
        at = arguments.index("--out")
        del arguments[at : at + 2]
    text = shlex.join([Path(arguments[0]).name, *arguments[1:]])
    return fence(" ".join(["console", *words]), "$ " + text.replace(" --", " \\\n    --"))


def picture(name: str, part: str) -> str:
    """Return the picture of a part of the run's report."""
    about = load(name).record.headline
    return f"![{PARTS[part][0]} of {name}: {about}]({{images}}/{name}-{part}.svg)"


def times(*names: str) -> str:
    """Return how long runs took, one a row."""
    runs = [load(name) for name in names]
    lines = tuple(
        line(
            str(run.record.question.n_scenes),
            str(len(run.record.question.seeds)),
            str(trials(run)),
            duration(run),
            run.processor,
            str(run.provenance.workers),
        )
        for run in runs
    )
    heads = ("Seeds", "Trials", "Time", "Processor", "Workers")
    table = Table(corner="Scenes", columns=heads, words=("Processor",), lines=lines)
    return "\n\n".join([grid(table), " ".join(dict.fromkeys(run.flown for run in runs))])


def trials(run: Run) -> int:
    """Return the trials flown: a treatment that a fault cannot reach is that under correct
    inputs."""
    conditions, question = run.record.conditions, run.record.question
    treatments = {("repair", condition.readers) for condition in conditions}
    treatments |= {("baseline", condition.baseline_readers) for condition in conditions}
    return len(treatments) * question.n_scenes * len(question.seeds)


def duration(run: Run) -> str:
    """Return the wall time of a run; `Wrong` for one that resumed and did not do it all."""
    if run.provenance.blocks_kept:
        raise Wrong(
            f"docs/reference/{run.name} kept {run.provenance.blocks_kept} blocks of an earlier "
            "invocation, so its wall time is not that of the run; run it in a new folder"
        )
    minutes, seconds = divmod(round(run.provenance.wall_s), 60)
    return f"{minutes} min {seconds:02d} s" if minutes else f"{seconds} s"


def sentences(name: str) -> str:
    """Return headline and sentences of a map or scan as a quotation, and how it was run."""
    run = load(name)
    lines = [f"> **{run.record.headline}**", *(f"> {text}" for text in run.record.sentences)]
    return "\n>\n".join(lines) + f"\n\nProcessor: {run.processor}. {run.flown}"


def map_picture_of(name: str, part: str) -> Picture:
    """Return the picture of a map, or of its success by correlation."""
    record = load(name).record
    svg = MAP_PICTURES[part](record).render(standalone=True) + "\n"
    return Picture(f"{name}-{part}.svg", record.headline, svg)


def scan_picture_of(name: str) -> Picture:
    """Return the triangle of pairs of the first variant of a scan."""
    record = load(name).record
    svg = triangle(record, record.versions[0]).render(standalone=True) + "\n"
    return Picture(f"{name}-pairs.svg", record.headline, svg)


def scan_commands(name: str) -> str:
    """Return the commands that audit the pairs that a scan listed."""
    return fence("text", "\n".join(load(name).record.commands))


def wpilib_pairs() -> str:
    """Return the pairs of errors that WPILib's design names, at its own sizes, one a row."""
    rows = [
        (
            f"`{pair['diameter']}`",
            f"`{pair['latency']}`",
            *(f"{pair[name]:.0f}" for name in ("none", "first", "second", "both")),
            "cancel" if pair["kind"] == "cancel" else "",
        )
        for pair in figures_of("wpilib", "pairs.json")
    ]
    heads = ("Diameter", "Latency", "neither", "diameter", "latency", "both", "")
    return pipes(heads, rows, words=(0, 1, 6))


def code(place: str, part: str, *words: str) -> str:
    """Return a file's part below the line `# --- PART ---`; `words` follow the fence."""
    pieces = re.split(r"^ *# --- (.+) ---\n", (ROOT / place).read_text("utf-8"), flags=re.MULTILINE)
    parts = dict(zip(pieces[1::2], pieces[2::2], strict=True))
    if part not in parts:
        raise Wrong(f"{place} has no part '{part}'; it has {', '.join(parts)}")
    return fence(" ".join(["python", *words]), parts[part].rstrip().strip("\n"))


def template(kind: str, name: str, *parts: str) -> str:
    """Return the file that `faultpath init NAME --with KIND` writes, or parts of it.

    A part is a function, by its name; `imports` is what stands above the first one.
    """
    folder = ROOT / "src" / "faultpath" / "system" / "templates"
    text = (folder / f"{kind}.py.txt").read_text("utf-8").replace("NAME", name).rstrip()
    if not parts:
        return fence("python", text)
    head, *functions = text.split("\n\n\n")
    pieces = {"imports": head} | {
        re.findall(r"^def (\w+)", function, re.MULTILINE)[0]: function for function in functions
    }
    if unknown := [part for part in parts if part not in pieces]:
        raise Wrong(f"template {kind} has no part '{unknown[0]}'; it has {', '.join(pieces)}")
    return fence("python", "\n\n\n".join(pieces[part] for part in parts))
