"""What the marked blocks of the documents show of the shipped reproduction of the paper."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path

from blocks import REFERENCE, ROOT, Wrong
from pydantic import ValidationError

from faultpath.record import ClaimVerdict, Reproduction, RunProvenance
from faultpath.report.reproduction import ledger_markdown
from faultpath.tables import Table, line
from faultpath.tables.markdown import block, grid

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
    try:
        found = Reproduction.model_validate_json((SHIPPED / FILES[0]).read_bytes())
        origin = RunProvenance.model_validate_json((SHIPPED / FILES[1]).read_bytes())
    except (OSError, ValidationError) as error:
        raise Wrong(f"{SHIPPED} cannot be read; take the run again ({error})") from None
    return found, origin


def paper(part: str, *names: str) -> str:
    """Return a part of the shipped run; `Wrong` for one that there is not."""
    run = load()
    if run is None:
        return "*The paper has not been flown yet.*"
    if part not in _PARTS:
        raise Wrong(f"the paper has no part '{part}': use {', '.join(_PARTS)}")
    return _PARTS[part](*run, *names)


def _counts(found: Reproduction, origin: RunProvenance) -> str:
    ledger = found.ledger
    return (
        f"Of the paper's {len(ledger.claims)} claims, {ledger.count('confirmed')} are confirmed, "
        f"{ledger.count('refuted')} refuted and {ledger.count('undecided')} undecided on "
        f"{ledger.scenes} scenes of `{ledger.library}`, seeds "
        f"{', '.join(map(str, ledger.seeds))} ({found.trials:,} trials)."
    )


def _ledger(found: Reproduction, origin: RunProvenance) -> str:
    return ledger_markdown(found.ledger)


def _claim(found: Reproduction, origin: RunProvenance, name: str) -> str:
    """Return every statement of one claim."""
    claim = _by_id(found, name)
    lines = [f"**{claim.id}, {claim.verdict}.** {claim.claim}. The paper: {claim.paper}.", ""]
    for part in claim.parts:
        numbers = "" if part.estimate is None else f": {part.estimate:.3g} {part.unit}"
        if part.interval is not None:
            numbers += f" [{part.interval[0]:.3g}, {part.interval[1]:.3g}]"
        lines.append(f"- {part.answer}: {part.words}{numbers}")
    return "\n".join(lines)


def _table(found: Reproduction, origin: RunProvenance, name: str) -> str:
    tables = {table.name: table for table in found.tables}
    if name not in tables:
        raise Wrong(f"the paper has no table '{name}': use {', '.join(tables)}")
    return block(tables[name])


def _motors(found: Reproduction, origin: RunProvenance) -> str:
    """Return what `tools/motor_state.py` measured."""
    try:
        measured = json.loads((REFERENCE / "motor-state.json").read_text("utf-8"))
    except FileNotFoundError:
        return "*Not measured yet: run tools/motor_state.py.*"
    lines = [line("true-parameter predictor", f"{measured['predictor_cm']:.1f}")]
    for intervals, error in measured["plant_cm"].items():
        lines.append(line(f"plant, motors followed for {intervals} intervals", f"{error:.1f}"))
    heads = ("Median 20-step position error (cm)",)
    return (
        f"{grid(Table(corner='Predicted by', columns=heads, lines=tuple(lines)))}\n\n"
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


def _by_id(found: Reproduction, name: str) -> ClaimVerdict:
    for claim in found.ledger.claims:
        if claim.id == name:
            return claim
    raise Wrong(f"there is no claim '{name}'")


def take(folder: Path, reference: Path) -> None:
    """Ship a run of the whole paper: `Wrong` when it is not finished."""
    absent = [file for file in (*FILES, *PAGES) if not (folder / file).is_file()]
    if absent:
        raise Wrong(f"{folder} holds no finished reproduction: it has no {', '.join(absent)}")
    for place, files in ((SHIPPED, FILES), (reference / "paper", PAGES)):
        place.mkdir(parents=True, exist_ok=True)
        for file in files:
            (place / file).write_bytes((folder / file).read_bytes())


_PARTS: dict[str, Callable[..., str]] = {
    "counts": _counts,
    "ledger": _ledger,
    "claim": _claim,
    "table": _table,
    "origin": _origin,
    "motors": _motors,
    "picture": _picture,
}
