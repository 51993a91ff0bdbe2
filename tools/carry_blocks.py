"""Blocks of the page about the carry-over of verdicts."""

import sys
from functools import cache
from itertools import product
from pathlib import Path

from blocks import REFERENCE, ROOT, TAKE_AGAIN, about, copied, parsed
from flown_code import flown_by

from faultpath.decisions.sentences import wording
from faultpath.decisions.sentences.wording import counted
from faultpath.decisions.tables import Entry, Line, Table, line
from faultpath.decisions.tables.markdown import grid
from faultpath.trials.provenance import RunProvenance

sys.path.insert(0, str(ROOT / "experiments" / "carry-over"))
from carry_design import Cell, Flown
from carry_verdicts import Mean, hours, lead, moves, overall, questions, reason, sentences, title

CELLS = "cells.json"
TAKEN = (CELLS, "provenance.json")
NODES = 10
MARKS = {1: "repair", -1: "baseline", 0: "·"}


@cache
def load(name: str) -> Flown:
    """Return a flown study; `Wrong` for a damaged file, and where there is none."""
    return parsed(REFERENCE / name / CELLS, Flown, TAKE_AGAIN)


def take(name: str, folder: Path) -> None:
    """Make the folder of a study a reference run."""
    copied(TAKEN, folder, REFERENCE / name)
    load.cache_clear()


def _said(flown: Flown) -> str:
    return "\n".join(f"- {sentence}" for sentence in sentences(flown))


def _matrix(flown: Flown) -> str:
    """Return a table per question and path: planner, estimator and plant down, the rest across."""
    parts: list[str] = []
    means = {(q.repair, q.baseline, reach): mean for q, reach, mean in overall(flown)}
    for question, reach, cells in questions(flown):
        if not cells:
            continue
        used = {
            factor: [level for level in levels if any(c.levels[factor] == level for c in cells)]
            for factor, levels in flown.design.factors.items()
        }
        down, across = list(used)[:3], list(used)[3:]
        by_levels = {tuple(cell.levels[name] for name in used): cell for cell in cells}
        columns = list(product(*(used[name] for name in across)))
        table = Table(
            columns=tuple(" ".join((*column[:-2], "".join(column[-2:]))) for column in columns),
            lines=tuple(
                line(", ".join(row), *(_entry(flown, by_levels.get((*row, *c))) for c in columns))
                for row in product(*(used[name] for name in down))
            ),
            corner=", ".join(down),
            words=(),
        )
        mean = means[question.repair, question.baseline, reach]
        whole = f"Mean over its cells, first {flown.design.first} scenes: {_shown(mean)} pp."
        parts += [f"**{title(question, reach)}**", grid(table), whole]
    return "\n\n".join(parts)


def _entry(flown: Flown, cell: Cell | None) -> Entry:
    if cell is None:
        return Entry(text="–")
    side = lead(flown.design, cell)
    return Entry(text=MARKS[side], detected=bool(side), aside="" if side else reason(cell))


def _shown(mean: Mean | None) -> str:
    if mean is None:
        return "–"
    ends = f"[{wording.plain(mean.low_pp)}, {wording.plain(mean.high_pp)}]"
    return f"{wording.signed(mean.value_pp)} {ends}"


def _factors(flown: Flown) -> str:
    lines: list[Line] = []
    all_moves = moves(flown)
    for question, reach, _ in questions(flown):
        own = [move for move in all_moves if (move.question, move.reach) == (question, reach)]
        lines += [Line(label=title(question, reach))] if own else []
        for move in own:
            counts = (move.same, move.opposite, move.one, move.neither)
            lines.append(
                line(
                    f"{move.factor} {' → '.join(move.levels)}",
                    *map(str, counts),
                    Entry(
                        text=_shown(move.change),
                        detected=move.change is not None and bool(move.change.sign),
                    ),
                )
            )
    columns = ("Same side", "Opposite", "At one level", "At neither", "Mean change, pp")
    return grid(Table(columns=columns, lines=tuple(lines), corner="Pairs of cells"))


def _cost(name: str) -> str:
    flown = load(name)
    origin = parsed(REFERENCE / name / "provenance.json", RunProvenance, TAKE_AGAIN)
    timed = sum(batch.trials for batch in flown.rounds)
    spent = sum(batch.seconds for batch in flown.rounds) / 60
    crowds = sorted({batch.workers for batch in flown.rounds})
    workers = f"{' or '.join(map(str, crowds))} worker{'s' * (crowds != [1])}"
    left = "".join(f" Left out: {level}: {why}" for level, why in flown.left_out.items())
    whole = "" if flown.complete else " The study was not flown to its end."
    design = flown.design
    return (
        f"{counted(len(flown.cells), 'cell')}, {design.first} to {design.most} scenes each of "
        f"`{design.library}`, {wording.seeds((design.seed,))}; {counted(flown.trials, 'trial')}. "
        f"{counted(timed, 'trial')} took {spent:.0f} minutes on {workers} ({origin.processor}); on "
        f"{NODES} nodes of two cores the same blocks would take {60 * hours(flown, NODES):.0f} "
        f"minutes, without what sending them costs.{whole}{left} "
        f"{flown_by(origin, 'quadrotor', flown.options)}"
    )


KIND = {**dict(about(load, _said, _matrix, _factors)), "cost": _cost}
"""Functions that fill the blocks of docs/carry-over.md, by kind."""
