"""Marked blocks of the documents about the shipped reproduction of the paper."""

import hashlib
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import blocks
from blocks import REFERENCE, ROOT, TAKE_AGAIN, Wrong, copied, parsed
from faultpath_paper.answers import RUN, Reproduction
from faultpath_paper.cells import SYSTEM, Setting
from faultpath_paper.central import (
    CASES,
    ELSEWHERE,
    QUESTION,
    WEIGHTS,
    Case,
    Effect,
    answer,
    case_of,
    detail,
    table_of,
)
from faultpath_paper.facts import SECTIONS, STANDINGS, counted, facts, listed
from faultpath_paper.report.page import sweep_plot
from faultpath_paper.report.short import apart, by_kind, by_subject
from faultpath_paper.report.words import NON_DETECTION, headline
from flown_code import flown_by
from pictures import IMAGES, standing

from faultpath.decisions.model import CORRECT, SHARED
from faultpath.decisions.sentences import wording
from faultpath.decisions.tables.escapes import markdown
from faultpath.decisions.tables.markdown import block, grid
from faultpath.trials.provenance import RunProvenance
from faultpath.trials.store.folder import read_outcomes

PLACE = REFERENCE / "paper"
FACTS = PLACE / "facts.md"
FILES = ("reproduction.json", "provenance.json", "outcomes.parquet", "evidence.parquet")
"""Files of a run that ship with the package: the claims are evaluated from them."""
PAGES = ("reproduction.html", "tables.md", "ledger.md")
"""Files of a run that are copied to `docs/reference/paper`."""
AGAIN = "quadrotor-L3"
"""The reference run that asks the question of Table IV, on the same scenes."""
BESIDES = ("quadrotor-L3-confirmation",)
"""Reference runs that ask the central question."""
_FAULT, _MODULE = "calibration=+0.1", "reconstruction"


@cache
def load() -> tuple[Reproduction, RunProvenance]:
    """Return the shipped run; `Wrong` for a damaged one."""
    record = parsed(RUN / FILES[0], Reproduction, TAKE_AGAIN)
    return record, parsed(RUN / FILES[1], RunProvenance, TAKE_AGAIN)


def take(folder: Path) -> None:
    """Ship a run of the whole paper; `Wrong` when it is not finished."""
    record = parsed(folder / FILES[0], Reproduction, "give the folder of a finished run")
    if record.profile != "paper":
        raise Wrong(f"{folder} is a {record.profile} run: what is shipped is one of profile paper")
    copied(FILES, folder, RUN)
    copied(PAGES, folder, PLACE)
    load.cache_clear()


def pictures() -> Mapping[Path, str]:
    """Return the paper's figures, by their path."""
    figures = load()[0].figures
    return {IMAGES / f"paper-{figure.name}.svg": standing(sweep_plot(figure)) for figure in figures}


def central_answer() -> str:
    """Return the paper's central question and our answer, in words that need no glossary."""
    cases = _cases()
    return f"{QUESTION} **{answer(cases)}.** {detail(cases)}"


def central_table() -> str:
    """Return the numbers behind the answer, run by run."""
    return block(table_of(_cases()))


def elsewhere() -> Mapping[Path, str]:
    """Return the file with what reference runs detected on the central question, by its path."""
    return {ELSEWHERE: CASES.dump_json(_besides(), indent=1).decode() + "\n"}


def _cases() -> tuple[Case, ...]:
    """Return what the shipped run detected, if it was flown on the platform that is here, and what
    reference runs did."""
    own = case_of(load()[0])
    return (*([own] if own and not _former() else []), *_besides())


def _former() -> str:
    """Return a sentence where the shipped run was flown on another platform than the one here."""
    weights = ROOT / "quadrotor" / "src" / "faultpath_quadrotor" / WEIGHTS
    if load()[1].data[WEIGHTS] == hashlib.sha256(weights.read_bytes()).hexdigest():
        return ""
    return "**On a platform before the present one.** "


def _besides() -> tuple[Case, ...]:
    return tuple(_case(name) for name in BESIDES)


def _case(name: str) -> Case:
    run = blocks.load(name)
    record = run.record
    effects = {effect.path: effect for effect in record.effects}
    isolated, shared = (
        Effect.of(wording.with_interval(effect.success), effect.detected)
        for effect in (effects[_MODULE], effects[SHARED])
    )
    question = record.question
    return Case(
        place=f"{record.scenes} scenes of {question.library}, {wording.seeds(question.seeds)}",
        isolated=isolated,
        shared=shared,
        reversal=any(
            change.isolated == _MODULE and change.turn == "reversal" for change in record.changes
        ),
        reversing=sum(
            one > 0 > two
            for one, two in zip(
                *(effects[path].success.per_seed or () for path in (_MODULE, SHARED)), strict=True
            )
        ),
        trainings=len(question.seeds),
        weights=run.provenance.data[WEIGHTS],
    )


def _counts() -> str:
    record, ledger = load()[0], load()[0].ledger
    return (
        f"{_former()}{headline(ledger, record.profile)} ({ledger.scenes} scenes of "
        f"`{ledger.library}`, seeds {', '.join(map(str, ledger.seeds))}; {record.trials:,} trials)."
    )


def _apart() -> str:
    return "\n".join(
        f"- **{verdict}.** {markdown(decisive)}." for verdict, decisive in apart(load()[0].ledger)
    )


def _picture(part: str) -> str:
    record = load()[0]
    titles = {exhibit.name: exhibit.title for exhibit in (*record.tables, *record.figures)}
    return f"![{titles.get(part, part)}]({{images}}/paper-{part}.svg)"


def _origin() -> str:
    origin = load()[1]
    place = f"[`docs/reference/{PLACE.relative_to(REFERENCE)}`]"
    again = "" if _former() else _run_again()
    return (
        f"Finished on {origin.finished[:10]}, with {origin.workers} workers on "
        f"{origin.processor.replace('(R)', '')}, and concluded anew by the code that is here, "
        f"which a test repeats. {flown_by(origin, SYSTEM, {})} {again}Everything is in "
        f"{place}({{reference}}/{PLACE.relative_to(REFERENCE)}): the report, the ledger and all "
        "tables."
    )


def _run_again() -> str:
    """Return how many trials a reference run has repeated, and how many came out alike."""
    paths = {CORRECT: CORRECT, SHARED: _FAULT, _MODULE: f"{_FAULT}@{_MODULE}"}
    setting = Setting(wind="L3")
    here = {
        (row.variant, f"{setting}: {paths[row.path]}", row.seed, row.outcome.scene): row.outcome
        for row in read_outcomes(REFERENCE / AGAIN / FILES[2]).rows
        if row.path in paths
    }
    there = {
        (row.variant, row.path, row.seed, row.outcome.scene): row.outcome
        for row in read_outcomes(RUN / FILES[2]).rows
    }
    pairs = [(here[key], there[key]) for key in here.keys() & there.keys()]
    alike = sum(one == other for one, other in pairs)
    return (
        f"{len(pairs):,} of its trials were repeated by the reference run [`{AGAIN}`]"
        f"({{reference}}/{AGAIN}): {alike:,} came out alike to the last bit. "
    )


def fact_page() -> Mapping[Path, str]:
    """Return the page with every fact, by its path."""
    words = ", ".join(
        f"{sum(fact.state == state for fact in facts())} {state}" for state in STANDINGS
    )
    parts = [
        "# What the paper states, fact by fact",
        f"{len(facts())} facts: {words}. *As written*: what the paper says. *Our reading*: the "
        "paper is silent there, or can be read in several ways. *Otherwise*: something else. "
        "Places are files of `quadrotor/src/faultpath_quadrotor`, or of `src` from `faultpath/` "
        "on and of `paper/src` from `faultpath_paper/` on, each with a name in the file. `make "
        "docs` makes this page from `paper/src/faultpath_paper/data/facts.yaml`.",
    ]
    for section, title in SECTIONS.items():
        parts += [f"## {title}", grid(listed(section))]
    return {FACTS: "\n\n".join(parts) + "\n"}


def _facts() -> str:
    """Return the counts by section, and every fact that is otherwise with its reason."""
    every = facts()
    otherwise = [fact for fact in every if fact.state == "otherwise"]
    items = [
        f"- **{fact.number}.** *The paper:* {markdown(fact.fact)} *Here:* {markdown(fact.ours)}"
        for fact in otherwise
    ]
    where = f"{{reference}}/{FACTS.relative_to(REFERENCE)}"
    return "\n\n".join(
        [
            grid(counted()),
            f"Otherwise ([all {len(every)} facts]({where}), with their places in the code):",
            "\n".join(items),
        ]
    )


KIND: dict[str, Callable[..., str]] = {
    "counts": _counts,
    "ledger": lambda: f"{grid(by_kind(load()[0].ledger))}\n\n{markdown(NON_DETECTION)}",
    "sizes": lambda: grid(by_subject(load()[0].ledger)),
    "apart": _apart,
    "facts": _facts,
    "origin": _origin,
    "picture": _picture,
}
"""Functions that fill the blocks about the paper, by kind."""
