"""The language of `data/statements.yaml`: what a statement is about, and the paper's figure of it.

An entry such as `{success: [table-4 gru shared, table-4 gru correct]}` names a quantity and the
terms that it is of. The paper's figure follows from those of the terms; else `paper` gives the keys
at which `data/published.yaml` has it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, NamedTuple

from faultpath.system import Status
from faultpath_paper.cells import SEEDS, Printed, of_seed, published
from faultpath_paper.claims.paying import pays
from faultpath_paper.claims.statement import Statement, seeds_that_turn, stated, turns_down
from faultpath_paper.pages import (
    figure_3,
    in_text,
    table_1,
    table_2,
    table_3,
    table_4,
    table_5,
    table_6,
)
from faultpath_paper.pages.grid import Grid
from faultpath_paper.quantities import differences as trials
from faultpath_paper.quantities import summaries, windows
from faultpath_paper.results import Quantity

Asked = tuple[Quantity, Printed | None]
"""A quantity, and the paper's figure of it."""


class Term(NamedTuple):
    """A cell, or the measurements of its seeds."""

    of: Any
    paper: float | None = None
    """The paper's figure of it."""
    place: tuple[Grid, str, Any] | None = None
    """Table, row and column."""


def term(words: str) -> Term:
    """Return the term of words such as `table-4 gru shared`; `ValueError` for no term."""
    text = published("in_text")
    match words.split():
        case ["table-1", key]:
            return Term(of_seed(table_1.CELLS[key]), table_1.PAPER[key]["success"])
        case ["table-2", model, error]:
            return _in(table_2.GRID, model, float(error))
        case ["table-3", variant, environment, level]:
            return _in(table_3.GRIDS[environment], variant, level)
        case ["table-4", method, condition]:
            return _in(table_4.GRID, method, condition)
        case ["table-6", method, condition]:
            return _in(table_6.GRID, method, condition)
        case ["figure-3", model, error]:
            return Term(figure_3.cell(model, float(error)))
        case ["text", name]:
            return Term(in_text.CELLS[name], text["success"].get(name))
        case ["planner", name]:
            return Term(in_text.PLANNERS[name])
        case ["noisy", model, "0"]:
            return Term(in_text.noisy(model, 0.0), text["noise_and_delay_success"][model])
        case ["noisy", model, error]:
            return Term(in_text.noisy(model, float(error)))
        case ["noisy-wind", variant]:
            return Term(in_text.noisy_wind(variant))
        case ["once", *of]:
            return Term(replace(term(" ".join(of)).of, fixed=True), term(" ".join(of)).paper)
        case ["every-seed", *of]:
            return Term(replace(term(" ".join(of)).of, seeds=SEEDS), term(" ".join(of)).paper)
        case ["common-error", key]:
            cell, paper = table_1.CELLS[key], table_1.PAPER[key]
            return Term((table_1.common_error(cell),), paper["error_common_cm"])
        case ["windy-error", variant]:
            return Term((in_text.windy_error(variant),))
        case ["response", model, probe]:
            figures = text["response_cm"].get(probe, {})
            return Term((in_text.response(model, probe),), figures.get(model))
        case ["acceleration-error" | "wind-term-error" | "position-error" as error, *of]:
            return Term(table_6.errors(error, *of), table_6.PRINTED.get((error, *of)))
        case _:
            raise ValueError(f"'{words}' is no term")


def _in(grid: Grid, row: str, column: Any) -> Term:
    return Term(grid.cell(row, column), grid.rate(row, column), (grid, row, column))


def _minus(one: Term, two: Term, times: float = 1.0) -> Printed | None:
    """Return the difference of what the paper prints, by itself or as that of two rows."""
    if one.place and two.place and one.place[::2] == two.place[::2]:
        grid, row, column = one.place
        if contrast := grid.contrast(row, two.place[1], column):
            return contrast
    if one.paper is None or two.paper is None:
        return None
    return Printed(times * (one.paper - two.paper))


def _asked(kind: str, of: Sequence[Any]) -> Asked:
    """Return the quantity of an entry; `ValueError` for an unknown one."""
    match kind, of:
        case "success" | "success, other noise", [first, second]:
            one, two, other = term(first), term(second), kind != "success"
            return trials.success(one.of, two.of, other_noise=other), _minus(one, two)
        case "crash" | "timeout", [first, second]:
            keys = [words.split()[1] for words in (first, second)]
            one, two = (Term(table_1.CELLS[key], table_1.PAPER[key][kind]) for key in keys)
            return trials.success(one.of, two.of, trials.ended(Status(kind))), _minus(one, two)
        case "sum", _:
            pairs = [(float(Fraction(by)), term(one), term(two)) for by, one, two in of]
            summed = trials.combined(*((by, (one.of, two.of)) for by, one, two in pairs))
            figures = [by * p.value for by, one, two in pairs if (p := _minus(one, two))]
            return summed, Printed(sum(figures))
        case "rate", [words]:
            return trials.rate(term(words).of), None
        case "time", [first, second]:
            return trials.time(term(first).of, term(second).of), None
        case "distance", [first, second, condition]:
            pair = table_4.pair(first, second, condition)
            return trials.combined((1, pair), effect=trials.terminal_distance), None
        case "moves", ["success", first, second]:
            return table_4.change(first, second, trials.succeeded), None
        case "moves", ["distance", first, second]:
            return table_4.change(first, second, trials.terminal_distance), None
        case "seeds that turn", [first, second]:
            return seeds_that_turn(*_alone_and_shared(first, second)), None
        case "median", [words]:
            one = term(words)
            return windows.median(one.of), None if one.paper is None else Printed(one.paper)
        case "medians", [first, second]:  # of common errors the paper prints centimetres
            one, two = term(first), term(second)
            return windows.difference_of_quantiles(one.of, two.of), _minus(one, two, 0.01)
        case "ratio", [first, second]:
            one, two = term(first), term(second)
            paper = Printed(one.paper / two.paper) if one.paper and two.paper else None
            return windows.ratio(one.of, two.of), paper
        case "change" | "size of change", _:  # from the first to the second, whatever its sign
            ends = [term(words) for changed in of for words in changed]
            moved, rival = (p.value for p in map(_minus, ends[1::2], ends[::2]) if p)
            size = kind == "size of change"
            paper = Printed(abs(moved) - abs(rival) if size else moved - rival)
            repair, other = (ends[0].of, ends[1].of), (ends[2].of, ends[3].of)
            return windows.difference_of_changes(repair, other, size=size), paper
        case "error at lower success", [q, *errors]:
            sides = [(table_2.cell("wm-a", e), (table_2.error_under(e),)) for e in errors]
            return summaries.at_lower_success(sides[0], sides[1], q), _error_at_lower(q, errors)
        case "rank correlation", [error]:
            cells = [(table_4.cell(*at), table_6.errors(error, *at)) for at in in_text.NINE]
            return summaries.rank_correlation(cells), None
        case "worst", [model]:
            return summaries.worst(model), None
        case "range gained", [first, second]:
            return summaries.range_gained(first, second), None
        case "share", [end]:
            return summaries.share(in_text.CEILING, end), None
        case "greater effect", [repair]:
            return trials.greater_effect(table_5.REPAIRS[repair]), None
        case _:
            raise ValueError(f"'{kind}: {of}' is no quantity")


def _error_at_lower(q: float, errors: Sequence[float]) -> Printed | None:
    """Return the error at the sign with less success, minus at the other; of medians alone."""
    first, at = table_2.GRID.figures["WM-A_seed0"], map(table_2.ERRORS.index, errors)
    less, more = sorted((first["success"][i], first["error_cm"][i]) for i in at)
    return Printed(0.01 * (less[1] - more[1])) if q == 0.5 else None


def _alone_and_shared(first: str, second: str) -> tuple[trials.Pair, trials.Pair]:
    alone, shared = (table_4.pair(first, second, where) for where in table_4.GRID.columns[1:])
    return alone, shared


def statement(words: str, entry: Mapping[str, Any]) -> Statement:
    """Return the statement of an entry of `data/statements.yaml`."""
    (kind, of), *_ = entry.items()
    if kind == "pays":
        return pays(words, *of)
    if kind == "turns":
        first, second = of
        columns = table_4.GRID.columns[1:]
        alone, shared = (table_4.GRID.contrast(first, second, column) for column in columns)
        assert alone
        assert shared
        paper = Printed(shared.value - alone.value)
        return turns_down(words, *_alone_and_shared(first, second), paper)
    quantity, paper = _asked(kind, of)
    return stated(words, quantity, _printed(*entry["paper"]) if "paper" in entry else paper)


def _printed(*keys: str) -> Printed:
    """Return a figure of `data/published.yaml`, with its interval where it has one."""
    figure = published(*keys)
    if isinstance(figure, int | float):
        return Printed(figure)
    low, high = figure["ci95"]
    return Printed(figure["mean"], (low, high))
