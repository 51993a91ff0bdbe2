"""Blocks of the page on results under other conditions."""

from collections.abc import Sequence

from blocks import load
from carry_design import Cell
from carry_verdicts import Mean, hours, lead, moves, overall, questions, reason, sentences, title

from faultpath.analyses.sentences import wording
from faultpath.analyses.sentences.wording import counted
from faultpath.analyses.tables import MISSING, Entry, Table, line
from faultpath.analyses.tables.markdown import grid

NODES = 10
SIDES = {1: "repair", -1: "baseline"}


def verdicts(name: str) -> str:
    """Return what is decided of each question, in sentences."""
    return "\n".join(f"- {sentence}" for sentence in sentences(load(name).record))


def table(name: str) -> str:
    """Return in how many cells who is ahead, the mean, and what each factor changes of it.

    A column is a question with the fault at one place.
    """
    flown = load(name).record
    cells = {title(q, reach): cells for q, reach, cells in questions(flown) if cells}
    leads = {head: [lead(flown.design, cell) for cell in cells[head]] for head in cells}
    means = {title(question, reach): mean for question, reach, mean in overall(flown)}
    changes: dict[str, dict[str, Mean | None]] = {}
    for move in moves(flown):
        row = changes.setdefault(f"{move.factor} {' → '.join(move.levels)}", {})
        row[title(move.question, move.reach)] = move.change

    ahead = [
        line(f"{name} ahead in", *(str(leads[head].count(side)) for head in cells))
        for side, name in SIDES.items()
    ]
    factors = [
        line(factor, *(_entry(row.get(head)) for head in cells)) for factor, row in changes.items()
    ]
    lines = (
        line("cells", *(str(len(of)) for of in cells.values())),
        *ahead,
        line("floor or ceiling in", *(str(_at_an_end(of)) for of in cells.values())),
        line("mean difference, pp", *(_entry(means[head]) for head in cells)),
        *factors,
    )
    return grid(Table(columns=tuple(cells), lines=lines, corner="", words=()))


def _at_an_end(cells: Sequence[Cell]) -> int:
    return sum(reason(cell) in ("floor", "ceiling") for cell in cells)


def _entry(mean: Mean | None) -> Entry:
    if mean is None:
        return Entry(text=MISSING)
    ends = f"[{wording.plain(mean.low_pp)}, {wording.plain(mean.high_pp)}]"
    return Entry(text=f"{wording.signed(mean.value_pp)} {ends}", detected=bool(mean.sign))


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
