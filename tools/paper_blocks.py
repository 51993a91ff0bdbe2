"""The shipped reproduction of the paper, for its blocks, pictures and pages."""

import hashlib
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import blocks
from blocks import REFERENCE, ROOT, Picture, Run, Wrong, copied, parsed, read_run
from faultpath_paper.answers import RUN, Reproduction
from faultpath_paper.cells import Setting
from faultpath_paper.central import (
    CASES,
    ELSEWHERE,
    WEIGHTS,
    Case,
    PrintedEffect,
    case_of,
)
from faultpath_paper.report.page import sweep_plot

from faultpath.analyses.model import CORRECT, SHARED
from faultpath.report.sentences import phrases, wording
from faultpath.report.svg import template
from faultpath.run.store.folder import read_outcomes

PLACE = REFERENCE / "paper"
FACTS = PLACE / "facts.md"
RECORD = "reproduction.json"
FILES = (RECORD, "provenance.json", "outcomes.parquet", "evidence.parquet")
"""Files of a run that ship with the package: the claims are evaluated from them."""
PAGES = ("reproduction.html", "tables.md", "ledger.md")
"""Files of a run that are copied to `docs/reference/paper`."""
AGAIN = "quadrotor-L3"
"""The reference run that asks the question of Table IV, on the same scenes."""
BESIDES = ("quadrotor-L3-confirmation", "quadrotor-L3-decision")
"""Reference runs that ask the central question; the last one's answer leads."""
_FAULT, _MODULE = "calibration=+0.1", "reconstruction"


@cache
def load() -> Run:
    """Return the shipped run; `Wrong` for a damaged one."""
    return read_run("paper", RUN / RECORD, Reproduction)


def take(folder: Path) -> None:
    """Ship a run of the whole paper; `Wrong` when it is not finished."""
    record = parsed(folder / RECORD, Reproduction, "give the folder of a finished run")
    if record.profile != "paper":
        raise Wrong(f"{folder} is a {record.profile} run: what is shipped is one of profile paper")
    copied(FILES, folder, RUN)
    copied(PAGES, folder, PLACE)
    load.cache_clear()


def cases() -> tuple[Case, ...]:
    """Return what the shipped run detected, if it was flown on the platform that is here, and what
    reference runs did."""
    own = case_of(load().record)
    return (*([own] if own and not former() else []), *_besides())


def former() -> str:
    """Return a sentence where the shipped run was flown on another platform than the one here."""
    weights = ROOT / "quadrotor" / "src" / "faultpath_quadrotor" / WEIGHTS
    if load().provenance.code.data[WEIGHTS] == hashlib.sha256(weights.read_bytes()).hexdigest():
        return ""
    return "**On a platform before the present one.** "


def elsewhere() -> Mapping[Path, str]:
    """Return the file with what reference runs detected on the central question, by its path."""
    return {ELSEWHERE: CASES.dump_json(_besides(), indent=1).decode() + "\n"}


def _besides() -> tuple[Case, ...]:
    return tuple(_case(blocks.load(name)) for name in BESIDES)


def _case(run: Run) -> Case:
    record, question = run.record, run.record.question
    effects = {effect.condition: effect for effect in record.effects}
    pair = effects[_MODULE], effects[SHARED]
    isolated, shared = (
        PrintedEffect.of(wording.with_interval(effect), effect.significant) for effect in pair
    )
    (moved,) = (change for change in record.changes if change.isolated == _MODULE)
    (frequency,) = (share for share in record.break_even if share.condition == SHARED)
    by_seed = zip(*(effect.per_seed for effect in pair), strict=True)
    return Case(
        place=f"{record.scenes} scenes of {record.facts.library}, {wording.seeds(question.seeds)}",
        isolated=isolated,
        shared=shared,
        change=PrintedEffect.of(wording.with_interval(moved), moved.significant),
        ahead=phrases.ahead(question, frequency)
        .replace(question.repair, "the retrained one")
        .replace(question.baseline, "the original"),
        reversal=(_MODULE, "reversal") in ((c.isolated, c.turn) for c in record.changes),
        reversing=sum(one > 0 > two for one, two in by_seed),
        trainings=len(question.seeds),
        weights=run.provenance.code.data[WEIGHTS],
    )


def picture(part: str) -> Picture:
    """Return the picture of one of the paper's figures."""
    figure = next(figure for figure in load().record.figures if figure.name == part)
    return Picture(f"paper-{part}.svg", figure.title, standalone(sweep_plot(figure)))


def standalone(drawing: str) -> str:
    """Return a drawing of a page as a file of its own: colours inside, and its title above it."""
    box = re.findall(r'viewBox="([^"]*)"', drawing)[0]
    title = re.findall(r"<title[^>]*>([^<]*)</title>", drawing)[0]
    left, top, width, height = map(float, box.split())
    x, y, wide, high = left - 12, top - 38, width + 24, height + 50
    head, _, rest = drawing.partition(">")
    head = re.sub(r'( viewBox| width| height| xmlns)="[^"]*"', "", head)
    own = template("reproduction.css", "faultpath_paper.report").splitlines()
    css = (
        template("tokens.css")
        + template("svg.css")
        + "".join(line for line in own if line.startswith(".fig"))
    )
    return (
        f'{head} viewBox="{x:g} {y:g} {wide:g} {high:g}" xmlns="http://www.w3.org/2000/svg" '
        f'width="{wide:g}" height="{high:g}"><style>{css}</style>'
        f'<rect class="paper" x="{x:g}" y="{y:g}" width="{wide:g}" height="{high:g}"/>'
        f'<text class="head" x="{left:g}" y="{top - 14:g}">{title}</text>{rest}\n'
    )


def flown_again() -> tuple[int, int]:
    """Return how many trials a reference run has repeated, and how many came out alike."""
    conditions = {CORRECT: CORRECT, SHARED: _FAULT, _MODULE: f"{_FAULT}@{_MODULE}"}
    setting = Setting(wind="L3")
    here = {
        (
            row.variant,
            f"{setting}: {conditions[row.condition]}",
            row.seed,
            row.outcome.scene,
        ): row.outcome
        for row in read_outcomes(REFERENCE / AGAIN / FILES[2])
        if row.condition in conditions
    }
    there = {
        (row.variant, row.condition, row.seed, row.outcome.scene): row.outcome
        for row in read_outcomes(RUN / FILES[2])
    }
    pairs = [(here[key], there[key]) for key in here.keys() & there.keys()]
    return len(pairs), sum(one == other for one, other in pairs)
