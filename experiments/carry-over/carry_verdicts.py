"""Decisions on each cell and each factor, and sentences that follow from these alone."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import get_args

import numpy as np
from carry_design import Cell, Design, Flown, Question, Reach
from numpy.typing import NDArray

from faultpath.core.text import counted
from faultpath.stats.betting import log_capital
from faultpath.stats.distributions import t_interval
from faultpath.stats.power import fewest_scenes

Floats = NDArray[np.float64]
_KINDS = np.array([-1.0, 0.0, 1.0])


def sign(differences: Floats, needed: float) -> int:
    """Return the side that is decided: 1 for the repair, -1 for the baseline, 0 for neither."""
    counts = (differences[:, None] == _KINDS).sum(axis=0).astype(float)
    ahead = [float(log_capital(_KINDS, n, 0.0, 1.0)) for n in (counts, counts[::-1])]
    return (ahead[0] >= needed) - (ahead[1] >= needed)


def settled(design: Design, cell: Cell, left: int) -> bool:
    """Return whether more scenes are of no use: a side is decided, or with `left` more none can be.

    Any rule of stopping leaves the bets what they are.
    """
    needed = design.needed[cell.baseline, cell.repair]
    more = [np.append(cell.differences, np.full(left, side)) for side in (1.0, -1.0)]
    hopeless = not any(sign(differences, needed) for differences in more)
    return cell.void or hopeless or bool(lead(design, cell))


def lead(design: Design, cell: Cell) -> int:
    """Return the side that is decided of a cell."""
    return 0 if cell.void else sign(cell.differences, design.needed[cell.baseline, cell.repair])


def reason(cell: Cell) -> str:
    """Say what stands in the way of a decision: failed trials, or two variants at one end."""
    if cell.void:
        return "void"
    rates = [letters.count("1") / len(letters) for letters in cell.ended if letters]
    return (
        "floor" if rates and max(rates) < 0.1 else "ceiling" if rates and min(rates) > 0.9 else ""
    )


def questions(flown: Flown) -> Iterator[tuple[Question, Reach, list[Cell]]]:
    """Yield each question on each condition, with its cells; none where nothing is shared."""
    for question in flown.design.questions:
        for reach in get_args(Reach):
            key = (question.baseline, question.repair, reach)
            cells = [c for c in flown.cells if (c.baseline, c.repair, c.reach) == key]
            if cells or reach == "isolated":
                yield question, reach, cells


def title(question: Question, reach: Reach) -> str:
    """Return what is compared, and where the fault strikes."""
    where = "shared fault" if reach == "shared" else f"{question.isolated} only"
    return f"{question.repair} against {question.baseline}, {where}"


def verdict(question: Question, reach: Reach, signs: Sequence[int]) -> str:
    """Say whether the paper's verdict carries over, or who is ahead where it names nobody."""
    cells, often = len(signs), Counter(signs)
    if not cells:
        return "not flown."
    every = "the only cell" if cells == 1 else f"all {cells} cells"
    if often[0] == cells:
        return f"inconclusive in {every}."
    names = {1: question.repair, -1: question.baseline}
    side = question.sign(reach) or (1 if often[1] >= often[-1] else -1)
    if often[side] == cells:
        ahead = f"{names[side]} is ahead in {every}"
    else:
        other = often[-side] or "none"
        ahead = f"{names[side]} is ahead in {often[side] or 'none'} of {cells} cells"
        ahead += f", {names[-side]} in {other}"
    if not question.sign(reach):
        return f"{ahead}; the paper puts neither ahead."
    if often[-side]:
        return f"does not carry over: {ahead}."
    if often[side] == cells:
        return f"carries over: {ahead}."
    return f"inconclusive in some cells: {ahead}."


@dataclass(frozen=True)
class Mean:
    """A mean over cells on the scenes that all of them flew, for new scenes like these.

    Their number was fixed beforehand. All intervals of a study hold together.
    """

    value_pp: float
    low_pp: float
    high_pp: float

    @property
    def sign(self) -> int:
        """The side that is decided: 1 towards the repair, -1 towards the baseline."""
        return (self.low_pp > 0) - (self.high_pp < 0)


@dataclass(frozen=True)
class Move:
    """Effect of a factor on a question: pairs of cells that are alike in all else."""

    question: Question
    reach: Reach
    factor: str
    levels: tuple[str, str]
    same: int
    """Pairs with the same side decided at both levels."""
    opposite: int
    one: int
    """Decided at one level alone, which shows no difference."""
    neither: int
    change: Mean | None
    """Change of the difference, from the first level to the second; `None` of too few scenes."""


def overall(flown: Flown) -> list[tuple[Question, Reach, Mean | None]]:
    """Return the mean difference over all cells of each question."""
    family = len(list(_pairs(flown)))
    return [
        (
            question,
            reach,
            _mean(flown, [cell.differences for cell in _whole(flown, cells)], 1.0, family),
        )
        for question, reach, cells in questions(flown)
    ]


def moves(flown: Flown) -> list[Move]:
    """Return what each factor does to each question, between each two of its levels."""
    every, results = list(_pairs(flown)), list[Move]()
    for question, reach, factor, levels, pairs in every:
        signs = [(lead(flown.design, one), lead(flown.design, two)) for one, two in pairs]
        first = flown.design.first
        changes = [
            two.differences[:first] - one.differences[:first]
            for one, two in pairs
            if len(_whole(flown, (one, two))) == 2
        ]
        results.append(
            Move(
                question=question,
                reach=reach,
                factor=factor,
                levels=levels,
                same=sum(one * two > 0 for one, two in signs),
                opposite=sum(one * two < 0 for one, two in signs),
                one=sum(bool(one) != bool(two) for one, two in signs),
                neither=sum(not one and not two for one, two in signs),
                change=_mean(flown, changes, 2.0, len(every)),
            )
        )
    return results


def _pairs(
    flown: Flown,
) -> Iterator[tuple[Question, Reach, str, tuple[str, str], list[tuple[Cell, Cell]]]]:
    for question, reach, cells in questions(flown):
        for factor, levels in flown.design.factors.items():

            def rest(cell: Cell, factor: str = factor) -> tuple[str, ...]:
                return tuple(cell.levels[name] for name in flown.design.factors if name != factor)

            for first, second in combinations(levels, 2):
                others = {rest(cell): cell for cell in cells if cell.levels[factor] == second}
                firsts = [cell for cell in cells if cell.levels[factor] == first]
                pairs = [(cell, others[rest(cell)]) for cell in firsts if rest(cell) in others]
                if pairs:
                    yield question, reach, factor, (first, second), pairs


def _whole(flown: Flown, cells: Sequence[Cell]) -> list[Cell]:
    return [c for c in cells if not c.void and len(c.differences) >= flown.design.first]


def _mean(flown: Flown, values: Sequence[Floats], bound: float, moves: int) -> Mean | None:
    """Return the mean over cells; a scene is one observation, whatever the number of cells."""
    scenes, family = flown.design.first, moves + sum(1 for _ in questions(flown))
    alpha = flown.design.alpha / family
    if not values or scenes < fewest_scenes(alpha):
        return None
    means = 100 * np.mean([differences[:scenes] for differences in values], axis=0)
    least = (100 / scenes) ** 2 / 12  # a mean of so many scenes is known no better
    low, high = (float(end) for end in t_interval(means, 1 - alpha, least))
    return Mean(float(means.mean()), max(low, -100 * bound), min(high, 100 * bound))


def moved(moves: Sequence[Move]) -> str:
    """Say what is decided on the moves of one question."""
    sentences: list[str] = []
    for move in moves:
        first, second = move.levels
        between = f"{move.factor} {first} and {second}"
        if move.opposite:
            pairs = move.same + move.opposite + move.one + move.neither
            sentences.append(
                f"Opposite sides are significantly ahead with {between}, in {move.opposite} of "
                f"{counted(pairs, 'pair')} of cells that are alike in all else."
            )
        if move.change and move.change.sign:
            to = move.question.repair if move.change.sign > 0 else move.question.baseline
            sentences.append(
                f"From {move.factor} {first} to {second} the mean difference moves to {to}."
            )
    return " ".join(sentences) or "No factor changes it significantly."


def sentences(flown: Flown) -> list[str]:
    """Return one paragraph a question and condition: its verdict, and what changes it."""
    every, paragraphs = moves(flown), list[str]()
    means = {(q.repair, q.baseline, reach): mean for q, reach, mean in overall(flown)}
    for question, reach, cells in questions(flown):
        parts = [verdict(question, reach, [lead(flown.design, cell) for cell in cells])]
        mean = means[question.repair, question.baseline, reach]
        if mean and mean.sign and len(cells) > 1:
            ahead = question.repair if mean.sign > 0 else question.baseline
            parts.append(f"On the mean of all its cells {ahead} is ahead.")
        own = [move for move in every if (move.question, move.reach) == (question, reach)]
        parts += [moved(own)] if own else []
        paragraphs.append(f"{title(question, reach)}: {' '.join(parts)}")
    return paragraphs


def hours(flown: Flown, nodes: int, workers: int = 2) -> float:
    """Return the hours that the same blocks take on more nodes of so many workers.

    A round takes as long as its blocks in turns, each as long as the mean of that round; what
    sending costs is left out.
    """
    seconds = 0.0
    for work in flown.rounds:
        block = work.seconds * max(1, work.workers) / work.blocks
        seconds += -(-work.blocks // (nodes * workers)) * block
    return seconds / 3600
