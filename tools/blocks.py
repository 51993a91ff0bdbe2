"""Marked blocks of the documents about reference runs and example files."""

import re
import shlex
import shutil
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any, TypeVar

from flown_code import ROOT, flown_by
from pydantic import BaseModel, ValidationError
from rich.console import Console, RenderableType

from faultpath.decisions.model import DecisionRecord
from faultpath.decisions.sentences import wording
from faultpath.decisions.tables import Table, line
from faultpath.decisions.tables.markdown import grid
from faultpath.report.tables import DIFFERENCE, by_quantity
from faultpath.report.terminal import decision
from faultpath.trials.provenance import RunProvenance

REFERENCE = ROOT / "docs" / "reference"
TAKE_AGAIN = "take the run again"
M = TypeVar("M", bound=BaseModel)


class Wrong(Exception):
    """A mistake that the editor of the documents has to correct."""


@dataclass(frozen=True)
class Run:
    """A reference run."""

    name: str
    record: DecisionRecord
    provenance: RunProvenance

    @property
    def trials(self) -> int:
        """Trials flown: an arm that a fault cannot reach is the one under correct inputs."""
        paths = self.record.paths
        arms = {("repair", p.consumers) for p in paths}
        arms |= {("baseline", p.baseline_consumers) for p in paths}
        return len(arms) * self.record.question.n_scenes * len(self.record.question.seeds)


def parsed(path: Path, model: type[M], again: str) -> M:
    """Return the model in a file; `Wrong` where it cannot be read, with the remedy `again`."""
    try:
        return model.model_validate_json(path.read_bytes())
    except (OSError, ValidationError) as error:
        reason = "missing" if isinstance(error, OSError) else f"of another version ({error})"
        raise Wrong(f"{path} is {reason}: {again}") from None


def copied(files: Collection[str], folder: Path, target: Path) -> None:
    """Copy files of a finished run; `Wrong` where it has not got them all."""
    if absent := [file for file in files if not (folder / file).is_file()]:
        raise Wrong(f"{folder} holds no finished run: it has no {', '.join(absent)}")
    target.mkdir(parents=True, exist_ok=True)
    for file in files:
        shutil.copyfile(folder / file, target / file)


@cache
def load(name: str) -> Run:
    """Return a reference run; `Wrong` for a damaged one, and where there is none."""
    folder = REFERENCE / name
    record = parsed(folder / "record.json", DecisionRecord, TAKE_AGAIN)
    return Run(name, record, parsed(folder / "provenance.json", RunProvenance, TAKE_AGAIN))


def table(run: Run) -> str:
    """Return success of both variants and their difference, one path a column."""
    record, question = run.record, run.record.question
    table = by_quantity(record, ("baseline", "repair", *DIFFERENCE, "holm", "break-even"))
    return "\n\n".join(
        [
            grid(table),
            f"{question.n_scenes} scenes of `{question.library}`, {wording.seeds(question.seeds)}, "
            f"fault `{question.fault}`. Bold: significant (interval and test agree after Holm's "
            f"correction for {record.hypotheses} contrasts). Floor, ceiling: both below 10 % or "
            f"above 90 %, no headline. Break-even: the fault frequency at which neither is ahead, "
            f"estimated, and those at which neither is significantly ahead. Intervals are for "
            f"{record.estimand}. Void pairs: "
            f"{sum(effect.void_pairs for effect in record.effects)}.{_tests(run)} {flown(run)}",
        ]
    )


def _tests(run: Run) -> str:
    tests = run.record.question.tests
    return f" Tests: {tests}." if tests else ""


def headline(run: Run) -> str:
    """Return the record's headline as a quotation."""
    return f"> **{run.record.headline}**"


def contrast(run: Run) -> str:
    """Return the two decided effects that point opposite ways: one module alone, and shared."""
    question, effects = run.record.question, {e.path: e for e in run.record.effects}
    shared = effects["shared"]
    opposed = [
        effect
        for effect in run.record.effects
        if effect.detected
        and effect.path not in ("correct", "shared")
        and effect.success.value * shared.success.value < 0
    ]
    if not shared.detected or len(opposed) != 1:
        raise Wrong(f"{run.name} has not decided one reversal: the block has nothing to say")

    def row(name: str, success: Any) -> str:
        ahead = question.repair if success.value > 0 else question.baseline
        shown = difference(success.value, *success.interval, bold=True)
        return f"| {name} | {shown} | `{ahead}` |"

    return "\n".join(
        [
            f"| The fault reaches | success of `{question.repair}` minus "
            f"`{question.baseline}`, pp | ahead |",
            "| :-- | --: | :-- |",
            row(f"the {opposed[0].path} alone, as in a test of one module", opposed[0].success),
            row("every module that reads the estimate, as in deployment", shared.success),
            "",
            f"{run.record.scenes} scenes, {wording.seeds(question.seeds)}; bold: significant at "
            f"5 % after Holm's correction. Flown by commit `{run.provenance.commit[:12]}`.",
        ]
    )


def difference(value: float, low: float, high: float, *, bold: bool) -> str:
    """Return a difference with its interval, in Markdown."""
    text = wording.signed(value, 1)
    ends = ", ".join(wording.signed(end, 1) for end in (low, high))
    return f"{f'**{text}**' if bold else text} [{ends}]"


def terminal(run: Run) -> str:
    """Return the record as the command line prints it, and by which code the run was flown."""
    return "\n\n".join([printed(decision(run.record)), flown(run)])


def printed(shown: RenderableType) -> str:
    """Return `shown` as a terminal of 100 columns prints it."""
    console = Console(file=StringIO(), width=100, record=True, color_system=None)
    console.print(shown)
    lines = (line.rstrip() for line in console.export_text().splitlines())
    return fence("text", "\n".join(lines).strip("\n"))


def command(run: Run, *words: str) -> str:
    """Return the command that made the run, where it goes left out; `words` follow the fence."""
    arguments = list(run.provenance.command)
    if "--out" in arguments:
        at = arguments.index("--out")
        del arguments[at : at + 2]
    text = shlex.join([Path(arguments[0]).name, *arguments[1:]])
    return fence(" ".join(["console", *words]), "$ " + text.replace(" --", " \\\n    --"))


def flown(run: Run) -> str:
    """Return by which code the run was flown, and whether that is the code that is here."""
    question = run.record.question
    return flown_by(run.provenance, question.system, question.options)


def origin(run: Run) -> str:
    """Return where the run comes from."""
    provenance, installed = run.provenance, run.provenance.packages
    packages = ", ".join(
        f"{name} {installed[name]}" for name in ("numpy", "torch") if name in installed
    )
    return (
        f"Made on {provenance.finished[:10]} by faultpath {provenance.faultpath_version} with "
        f"Python {provenance.python}, {packages}. {flown(run)} "
        f"Everything that the run left in small files is in [`docs/reference/{run.name}`]"
        f"({{reference}}/{run.name}): decision record, outcome table, provenance and report."
    )


def times(*names: str) -> str:
    """Return how long runs took, one a row."""
    runs = [load(name) for name in names]
    lines = tuple(
        line(
            str(run.record.question.n_scenes),
            str(len(run.record.question.seeds)),
            str(run.trials),
            duration(run),
            run.provenance.processor.replace("(R)", ""),
            str(run.provenance.workers),
        )
        for run in runs
    )
    heads = ("Seeds", "Trials", "Time", "Processor", "Workers")
    table = Table(corner="Scenes", columns=heads, words=("Processor",), lines=lines)
    return "\n\n".join([grid(table), " ".join(dict.fromkeys(map(flown, runs)))])


def duration(run: Run) -> str:
    """Return the wall time of a run; `Wrong` for one that resumed and did not do it all."""
    if run.provenance.blocks_kept:
        raise Wrong(
            f"docs/reference/{run.name} kept {run.provenance.blocks_kept} blocks of an earlier "
            "invocation, so its wall time is not that of the run; run it in a new folder"
        )
    minutes, seconds = divmod(round(run.provenance.wall_s), 60)
    return f"{minutes} min {seconds:02d} s" if minutes else f"{seconds} s"


def picture(run: Run, part: str) -> str:
    """Return the picture of a part of the run's report."""
    about = run.record.headline
    return f"![{PARTS[part][0]} of {run.name}: {about}]({{images}}/{run.name}-{part}.svg)"


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
    folder = ROOT / "src" / "faultpath" / "systems" / "templates"
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


def fence(info: str, body: str) -> str:
    """Return a fenced block."""
    return f"```{info}\n{body}\n```"


PARTS: dict[str, tuple[str, str]] = {
    "verdict": ("Verdict", ".masthead, #verdict > *"),
    "interface": ("Who gets the fault", "#interface > *"),
    "readers": ("Who gets the fault", ".forks .panels"),
    "effects": ("Effects of the repair", "#effects"),
    "flights": ("Some flights", "#flights > *"),
}
"""Parts of a report that may be pictured: name in words, and selector in the page."""


def about(
    load: Callable[[str], Any], *fills: Callable[..., str]
) -> Iterator[tuple[str, Callable[..., str]]]:
    """Yield kind and function of the blocks about a run that is loaded by its name."""
    for fill in fills:
        kind = fill.__name__.strip("_")
        yield kind, lambda name, *words, fill=fill: fill(load(name), *words)


KINDS: dict[str, Callable[..., str]] = {
    **dict(about(load, table, headline, contrast, terminal, command, origin, picture)),
    "times": times,
    "code": code,
    "template": template,
}
"""Functions that fill the blocks about runs and about the code of examples, by kind."""
