"""Blocks of the page about the carry-over of verdicts."""

from itertools import product

from blocks import load
from carry_design import Cell, Flown
from carry_verdicts import Mean, hours, lead, moves, overall, questions, reason, sentences, title

from faultpath.decisions.sentences import wording
from faultpath.decisions.sentences.wording import counted
from faultpath.decisions.tables import Entry, Line, Table, line
from faultpath.decisions.tables.markdown import grid

NODES = 10
MARKS = {1: "repair", -1: "baseline", 0: "·"}


def verdicts(name: str) -> str:
    """Return what is decided of each question, in sentences."""
    return "\n".join(f"- {sentence}" for sentence in sentences(load(name).record))


def matrix(name: str) -> str:
    """Return a table per question and condition: planner, estimator and plant down, the rest
    across."""
    flown = load(name).record
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
        by_levels = {tuple(cell.levels[factor] for factor in used): cell for cell in cells}
        columns = list(product(*(used[factor] for factor in across)))
        table = Table(
            columns=tuple(" ".join((*column[:-2], "".join(column[-2:]))) for column in columns),
            lines=tuple(
                line(", ".join(row), *(_entry(flown, by_levels.get((*row, *c))) for c in columns))
                for row in product(*(used[factor] for factor in down))
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


def factors(name: str) -> str:
    """Return what each factor changes, question by question."""
    flown = load(name).record
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


def cost(name: str) -> str:
    """Return how much was flown, what it took, and by which code it was flown."""
    run = load(name)
    flown, design = run.record, run.record.design
    timed = sum(batch.trials for batch in flown.rounds)
    spent = sum(batch.seconds for batch in flown.rounds) / 60
    crowds = sorted({batch.workers for batch in flown.rounds})
    workers = f"{' or '.join(map(str, crowds))} worker{'s' * (crowds != [1])}"
    left = "".join(f" Left out: {level}: {why}" for level, why in flown.left_out.items())
    whole = "" if flown.complete else " The study was not flown to its end."
    return (
        f"{counted(len(flown.cells), 'cell')}, {design.first} to {design.most} scenes each of "
        f"`{design.library}`, {wording.seeds((design.seed,))}; {counted(flown.trials, 'trial')}. "
        f"{counted(timed, 'trial')} took {spent:.0f} minutes on {workers} "
        f"({run.processor}); on {NODES} nodes of two cores the same blocks would take "
        f"{60 * hours(flown, NODES):.0f} minutes, without what sending them costs.{whole}{left} "
        f"{run.flown}"
    )
