"""What the marked blocks of the documents show of the shipped reproductions of the paper.

A block shows the run of the default platform, or of the newest that has one; a platform as its last
word names another: `paper:claim:C01:first`.
"""

import json
from collections.abc import Callable, Iterable
from functools import cache, partial
from pathlib import Path
from typing import TypeVar

from blocks import REFERENCE, TAKE_AGAIN, Wrong, copied, parsed, tabled
from flown_code import flown_by

from faultpath.record import CORRECT, SHARED, Reproduction, RunProvenance
from faultpath.report.reproduction.terminal import ledger_markdown
from faultpath.store import read_outcomes
from faultpath.studies import shipped
from faultpath.studies.cells import SYSTEM, Setting
from faultpath.tables import Table
from faultpath.tables.markdown import block

T = TypeVar("T")
FILES = ("reproduction.json", "provenance.json", "outcomes.parquet", "evidence.parquet")
"""What of a run is shipped with the package: the claims are evaluated from it."""
PAGES = ("reproduction.html", "tables.tex", "tables.md", "ledger.md")
"""What of a run stands in `docs/reference/paper`, below the name of its platform."""


AGAIN = "quadrotor-L3-seeds"
"""The reference run that asks what Table IV asks, of the same scenes."""
_FAULT, _MODULE = "calibration=+0.1", "reconstruction"


def present() -> str | None:
    """Return the platform whose run documents show, `None` where none has been flown."""
    there = shipped.shipped()
    default = shipped.default_platform()
    return default if default in there else there[-1] if there else None


@cache
def load(platform: str) -> tuple[Reproduction, RunProvenance]:
    """Return the shipped run of a platform; `Wrong` for a damaged one."""
    folder = shipped.RUNS / platform
    found = parsed(folder / FILES[0], Reproduction, TAKE_AGAIN)
    return found, parsed(folder / FILES[1], RunProvenance, TAKE_AGAIN)


def _part(fill: Callable[..., str], *names: str) -> str:
    platform = present()
    if names and names[-1] in shipped.shipped():
        names, platform = names[:-1], names[-1]
    return fill(*load(platform), *names) if platform else "*The paper has not been flown yet.*"


def _counts(found: Reproduction, origin: RunProvenance) -> str:
    ledger = found.ledger
    return (
        f"Of the paper's {len(ledger.claims)} claims, {ledger.count('confirmed')} are confirmed, "
        f"{ledger.count('refuted')} refuted and {ledger.count('undecided')} undecided on "
        f"{ledger.scenes} scenes of `{ledger.library}`, seeds "
        f"{', '.join(map(str, ledger.seeds))} ({found.trials:,} trials)."
    )


def _claim(found: Reproduction, origin: RunProvenance, name: str) -> str:
    claim = _named(found.ledger.claims, name, "id")
    lines = [f"**{claim.id}, {claim.verdict}.** {claim.claim}. The paper: {claim.paper}.", ""]
    for part in claim.parts:
        numbers = "" if part.estimate is None else f": {part.estimate:.3g} {part.unit}"
        if part.interval is not None:
            numbers += f" [{part.interval[0]:.3g}, {part.interval[1]:.3g}]"
        lines.append(f"- {part.answer}: {part.words}{numbers}")
    return "\n".join(lines)


def _table(found: Reproduction, origin: RunProvenance, name: str) -> str:
    return block(_named(found.tables, name, "name"))


def _named(parts: Iterable[T], name: str, key: str) -> T:
    known = {getattr(part, key): part for part in parts}
    if name not in known:
        raise Wrong(f"the paper has no '{name}': use {', '.join(known)}")
    return known[name]


def _motors(_: Reproduction, origin: RunProvenance) -> str:
    try:
        measured = json.loads((REFERENCE / "motor-state.json").read_text("utf-8"))
    except FileNotFoundError:
        return "*Not measured yet: run tools/motor_state.py.*"
    rows = [{"name": "true-parameter predictor", "error": measured["predictor_cm"]}] + [
        {"name": f"plant, motors followed for {intervals} intervals", "error": error}
        for intervals, error in measured["plant_cm"].items()
    ]
    columns = {"Median 20-step position error (cm)": "{error:1}"}
    return (
        f"{tabled('Predicted by', rows, columns)}\n\n"
        f"{measured['windows']:,} windows of the selection library, flown with the "
        "true-parameter model. Made by `python tools/motor_state.py RUN_FOLDER`."
    )


def _frozen(_: Reproduction, origin: RunProvenance) -> str:
    try:
        table = Table.model_validate_json((REFERENCE / "frozen-wind.json").read_bytes())
    except FileNotFoundError:
        return "*Not flown yet: run tools/frozen_wind.py.*"
    return f"{block(table)}\n\nMade by `python tools/frozen_wind.py RUN_FOLDER`."


def _picture(found: Reproduction, origin: RunProvenance, part: str) -> str:
    titles = {each.name: each.title for each in (*found.tables, *found.figures)}
    return f"![{titles.get(part, part)}]({{images}}/paper-{part}.svg)"


def _origin(found: Reproduction, origin: RunProvenance) -> str:
    first, last = (end[:16].replace("T", " ") for end in found.flown or ("", ""))
    platform = found.ledger.platform
    return (
        f"Flown on platform `{platform}` between {first} and {last} UTC, "
        f"with {origin.workers} workers on {origin.processor.replace('(R)', '')}, and concluded "
        "anew by the code that is here, which a test repeats. "
        f"{flown_by(origin, SYSTEM, {shipped.PLATFORM: platform})} "
        f"{_flown_again(platform)}"
        "Everything is in "
        f"[`docs/reference/paper/{platform}`]({{reference}}/paper/{platform}): the report, the "
        "ledger and all tables."
    )


def _flown_again(platform: str) -> str:
    """Say how many trials of a run a reference run has flown again, and how many came out alike."""
    again = REFERENCE / AGAIN
    if platform != shipped.default_platform() or not again.is_dir():
        return ""
    paths = {CORRECT: CORRECT, SHARED: _FAULT, _MODULE: f"{_FAULT}@{_MODULE}"}
    setting = Setting(wind="L3")
    here = {
        (row.variant, f"{setting}: {paths[row.path]}", row.seed, row.outcome.scene): row.outcome
        for row in read_outcomes(again / FILES[2]).rows
        if row.path in paths
    }
    there = {
        (row.variant, row.path, row.seed, row.outcome.scene): row.outcome
        for row in read_outcomes(shipped.RUNS / platform / FILES[2]).rows
    }
    pairs = [(here[key], there[key]) for key in here.keys() & there.keys()]
    alike = sum(one == other for one, other in pairs)
    return (
        f"{len(pairs):,} of its trials were flown again by the reference run [`{AGAIN}`]"
        f"({{reference}}/{AGAIN}): {alike:,} came out alike to the last bit. "
    )


def take(folder: Path, reference: Path) -> None:
    """Ship a run of the whole paper under its platform: `Wrong` when it is not finished."""
    found = parsed(folder / FILES[0], Reproduction, "give the folder of a finished run")
    platform = found.ledger.platform
    if found.profile != "paper" or platform not in shipped.platforms():
        raise Wrong(
            f"{folder} is a {found.profile} run on platform '{platform}': what is shipped is a run "
            f"of profile paper on {' or '.join(shipped.platforms())}"
        )
    copied(FILES, folder, shipped.RUNS / platform)
    copied(PAGES, folder, reference / "paper" / platform)


KIND: dict[str, Callable[..., str]] = {
    name: partial(_part, fill)
    for name, fill in {
        "counts": _counts,
        "ledger": lambda found, origin: ledger_markdown(found.ledger, found.profile),
        "claim": _claim,
        "table": _table,
        "origin": _origin,
        "motors": _motors,
        "frozen": _frozen,
        "picture": _picture,
    }.items()
}
