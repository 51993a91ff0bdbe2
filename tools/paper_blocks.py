"""What the marked blocks of the documents show of the shipped reproduction of the paper."""

import json
from collections.abc import Callable, Iterable
from functools import cache, partial
from pathlib import Path
from typing import TypeVar

from blocks import REFERENCE, ROOT, TAKE_AGAIN, Wrong, copied, parsed, tabled

from faultpath.record import Reproduction, RunProvenance
from faultpath.report.reproduction.terminal import ledger_markdown
from faultpath.tables.markdown import block

T = TypeVar("T")
SHIPPED = ROOT / "src" / "faultpath" / "studies" / "paper" / "run"
FILES = ("reproduction.json", "provenance.json", "outcomes.parquet", "evidence.parquet")
"""What of a run is shipped with the package: the claims are evaluated from it."""
PAGES = ("reproduction.html", "tables.tex", "tables.md", "ledger.md")
"""What of a run stands in `docs/reference/paper`."""


@cache
def load() -> tuple[Reproduction, RunProvenance] | None:
    """Return the shipped run, `None` where there is none; `Wrong` for a damaged one."""
    if not (SHIPPED / FILES[0]).is_file():
        return None
    found = parsed(SHIPPED / FILES[0], Reproduction, TAKE_AGAIN)
    return found, parsed(SHIPPED / FILES[1], RunProvenance, TAKE_AGAIN)


def _part(fill: Callable[..., str], *names: str) -> str:
    """Return a part of the shipped run."""
    run = load()
    return fill(*run, *names) if run else "*The paper has not been flown yet.*"


def _counts(found: Reproduction, origin: RunProvenance) -> str:
    ledger = found.ledger
    return (
        f"Of the paper's {len(ledger.claims)} claims, {ledger.count('confirmed')} are confirmed, "
        f"{ledger.count('refuted')} refuted and {ledger.count('undecided')} undecided on "
        f"{ledger.scenes} scenes of `{ledger.library}`, seeds "
        f"{', '.join(map(str, ledger.seeds))} ({found.trials:,} trials)."
    )


def _claim(found: Reproduction, origin: RunProvenance, name: str) -> str:
    """Return every statement of one claim."""
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
    """Return the part of that name; `Wrong` where there is none."""
    known = {getattr(part, key): part for part in parts}
    if name not in known:
        raise Wrong(f"the paper has no '{name}': use {', '.join(known)}")
    return known[name]


def _motors(_: Reproduction, origin: RunProvenance) -> str:
    """Return what `tools/motor_state.py` measured."""
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


def _picture(found: Reproduction, origin: RunProvenance, part: str) -> str:
    """Return the picture of a part of the report, by its place in the page."""
    titles = {each.name: each.title for each in (*found.tables, *found.figures)}
    return f"![{titles.get(part, part)}]({{images}}/paper-{part}.png)"


def _origin(found: Reproduction, origin: RunProvenance) -> str:
    first, last = found.flown or ("", "")
    commit = origin.commit[:12] if origin.commit else "unknown"
    return (
        f"Flown between {first[:16].replace('T', ' ')} and {last[:16].replace('T', ' ')} UTC, "
        f"with {origin.workers} workers on {origin.processor.replace('(R)', '')}, and concluded by "
        f"commit `{commit}`; concluded anew by the code that is here, which a test repeats. "
        "Everything is in "
        "[`docs/reference/paper`]({reference}/paper): the report, the ledger and all tables."
    )


def take(folder: Path, reference: Path) -> None:
    """Ship a run of the whole paper: `Wrong` when it is not finished."""
    copied(FILES, folder, SHIPPED)
    copied(PAGES, folder, reference / "paper")


KIND: dict[str, Callable[..., str]] = {
    name: partial(_part, fill)
    for name, fill in {
        "counts": _counts,
        "ledger": lambda found, origin: ledger_markdown(found.ledger),
        "claim": _claim,
        "table": _table,
        "origin": _origin,
        "motors": _motors,
        "picture": _picture,
    }.items()
}
