"""The paper beside the shipped runs of all platforms: claim by claim, and the main contrasts."""

from collections.abc import Callable, Iterable, Iterator
from functools import cache

from blocks import Wrong
from paper_blocks import load

from faultpath.errors import UserError
from faultpath.record import Ledger, Part
from faultpath.record.wording import signed
from faultpath.report.reproduction import words
from faultpath.studies import shipped
from faultpath.studies.cells import Cell, of_seed
from faultpath.studies.claims.rules import (
    ABOVE,
    BELOW,
    NO_DIFFERENCE,
    NO_GAIN,
    REPORTED,
    Rule,
)
from faultpath.studies.claims.statement import Statement, answered
from faultpath.studies.pages import table_2, table_3, table_4
from faultpath.studies.published import Printed
from faultpath.studies.quantities.differences import success
from faultpath.studies.run import read_results
from faultpath.tables import MISSING, Entry, Line, Table, line
from faultpath.tables.markdown import grid

THE_PAPER = "The paper"
_INPUTS = {
    table_3.WITHHELD: "wind-withheld",
    table_3.ZERO: "zero wind",
    table_3.TRAJECTORY: "trajectory GRU",
    table_3.GRU: "GRU",
    table_3.TRUE: "ground-truth wind",
}


def _claims() -> str:
    ledgers = [load(platform)[0].ledger for platform in shipped.shipped()]
    if not ledgers:
        return "*The paper has not been flown yet.*"
    heads = tuple(f"Platform {ledger.platform}" for ledger in ledgers)
    rows = zip(*(ledger.claims for ledger in ledgers), strict=True)
    lines = (
        line(
            first.id,
            words.typeset(first.paper),
            *(_answer(claim.verdict, words.estimate(claim), words.size(claim)) for claim in row),
            aside="platform" if first.kind == "platform" else "",
        )
        for row in rows
        for first in row[:1]
    )
    columns = (THE_PAPER, *heads)
    table = Table(corner="Claim", columns=columns, lines=tuple(lines), words=columns)
    return "\n\n".join(filter(None, [grid(table), *map(_about, ledgers)]))


def _about(ledger: Ledger) -> str:
    said = " ".join([words.sizes(ledger), *words.notes(ledger)]).strip()
    return said and f"- `{ledger.platform}`: {said}"


def _answer(*phrases: str) -> str:
    return "; ".join(filter(None, phrases))


def _contrasts() -> str:
    runs = [(platform, _measured(platform)) for platform in shipped.shipped()]
    if not runs:
        return "*The paper has not been flown yet.*"
    lines: list[Line] = []
    for heading, statements in CONTRASTS.items():
        lines.append(Line(label=heading))
        for statement in statements:
            parts = [found[statement.subject] for _, found in runs]
            theirs = next((words.papers(part) for part in parts if part.unit), MISSING)
            lines.append(line(statement.subject, theirs, *map(_shown, parts)))
    columns = (THE_PAPER, *(f"Platform {platform}" for platform, _ in runs))
    return grid(Table(columns=columns, lines=tuple(lines), words=columns))


def _shown(part: Part) -> Entry:
    return Entry(text=words.estimate(part) or MISSING, aside=part.size if part.unit else "")


@cache
def _measured(platform: str) -> dict[str, Part]:
    try:
        results, _ = read_results(shipped.shipped_run(platform))
    except UserError as error:
        raise Wrong(str(error)) from None
    every = (statement for several in CONTRASTS.values() for statement in several)
    return {statement.subject: answered(statement, results) for statement in every}


def _calibration() -> Iterator[Statement]:
    for repair, baseline in table_2.PAIRS:
        for error in table_2.ERRORS:
            yield _compared(
                f"{table_2.NAMES[repair]} minus {table_2.NAMES[baseline]}, e = "
                f"{signed(error, 1) if error else 0}",
                [table_2.cell(model, error) for model in (repair, baseline)],
                REPORTED,
                table_2.paper_repair(baseline, error),
            )


def _wind() -> Iterator[Statement]:
    true, zero, withheld, gru = table_3.TRUE, table_3.ZERO, table_3.WITHHELD, table_3.GRU
    asked: Iterable[tuple[str, str, str, Rule]] = (
        ("L2", zero, withheld, NO_GAIN),
        ("L3", zero, withheld, NO_GAIN),
        ("L3", true, zero, ABOVE),
        ("L3", gru, zero, ABOVE),
        ("L3", gru, true, NO_DIFFERENCE),
        ("L3", table_3.TRAJECTORY, gru, BELOW),
    )
    for environment in table_3.ENVIRONMENTS:
        where = environment.replace("-", " ")
        for level, first, second, rule in asked:
            cells = [table_3.cell(each, environment, level) for each in (first, second)]
            if rule is NO_GAIN and environment == "obstacles":  # of one training, as in C17
                cells = [of_seed(each) for each in cells]
            rates = [table_3.paper_rate(each, environment, level) for each in (first, second)]
            yield _compared(
                f"{_INPUTS[first]} minus {_INPUTS[second]}, {where}, {level}",
                cells,
                rule,
                Printed(rates[0] - rates[1]),
            )


def _shared() -> Iterator[Statement]:
    for first, second in (("gru+dcc", "gru"), ("dob", "gru"), ("dob", "gru+dcc")):
        for path in table_4.PATHS:
            yield _compared(
                f"{table_4.NAMES[first]} minus {table_4.NAMES[second]}, {path}",
                [table_4.cell(method, path) for method in (first, second)],
                REPORTED,
                table_4.paper_contrast(first, second, path),
            )


def _compared(subject: str, cells: list[Cell], rule: Rule, paper: Printed) -> Statement:
    return Statement(subject, success(*cells), rule, paper)


CONTRASTS: dict[str, tuple[Statement, ...]] = {
    "Table II, obstacles": tuple(_calibration()),
    "Table III": tuple(_wind()),
    "Table IV, obstacles at L3": tuple(_shared()),
}
"""Differences in success, first minus second, by the table that has them or their rates."""
KIND: dict[str, Callable[[], str]] = {"claims": _claims, "contrasts": _contrasts}
