"""The page of `make statistics`: every promise of the statistics, measured."""

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import product, repeat
from pathlib import Path
from typing import Any

import simulation_scan as scans
import yaml
from simulation import (
    LEANS,
    RATES,
    Population,
    alike,
    any_look,
    beside_failures,
    break_even_coverage,
    detection,
    equal_variants,
    interval_coverage,
    powered,
    reversals,
    trainings,
)
from simulation_blanks import BLANKS, blanks
from simulation_many import LEVELS, SCENES, largest_level
from simulation_skewed import skewed, skewed_coverage
from simulation_tables import Section, kept, markdown, merged, share, written

from faultpath.analyses.family import ALPHA

LOST = (0.005, 0.01, 0.02, 0.05)
"""Shares of scenes that lose all seeds."""


def table(
    corner: str, columns: Mapping[str, Any], rows: Mapping[str, Any], rates: Callable[..., Any]
) -> Callable[[], str]:
    """Return what measures a table: of a row and a column one rate, or the range of several."""

    def measured(row: Any, column: Any) -> str:
        found = rates(row, column)
        return share([found] if isinstance(found, float) else found)

    def written() -> str:
        lines = (
            (name, *(measured(row, of) for of in columns.values())) for name, row in rows.items()
        )
        return markdown((corner, *columns), lines)

    return written


def pairs(first: Iterable[int], second: Iterable[int]) -> dict[str, tuple[int, int]]:
    """Return all pairs by their names, such as `25, 3`."""
    return {f"{one}, {two}": (one, two) for one, two in product(first, second)}


def percent(shares: Iterable[float]) -> dict[str, float]:
    """Return shares by their names, such as `5 %`."""
    return {f"{100 * part:g} %": part for part in shares}


def structured(rate: float, lean: float, seeds: int) -> list[Population]:
    """Return populations whose seeds are independent or half alike, without and with effects."""
    if seeds == 1:
        return [Population(rate, lean)]
    kinds = product((0.0, 0.5), (False, True))
    return [Population(rate, lean, seeds, alike, own) for alike, own in kinds]


def sections() -> Iterator[Section]:
    """Yield everything that is measured."""
    by_rate, seeds = percent(RATES), {"1 seed": 1, "3 seeds": 3}
    yield (
        "Interval of an effect",
        table(
            *("scenes", by_rate, {f"{n}": n for n in (10, 25, 50, 100, 300)}),
            lambda scenes, rate: (
                interval_coverage(scenes, truth)
                for lean, count in product(LEANS, (1, 3, 5))
                for truth in structured(rate, lean, count)
            ),
        ),
    )
    yield (
        "Break-even frequency",
        table(
            *("scenes", by_rate, {f"{n}": n for n in (25, 100, 300)}),
            lambda scenes, rate: (
                break_even_coverage(scenes, cost, replace(cost, rate=gain, lean=1.0))
                for lean, gain, count in product((0.5, 1.0), (0.05, 0.3), (1, 3))
                for cost in structured(rate, -lean, count)
                if cost.mean <= 0.0
            ),
        ),
    )
    yield (
        "Least detectable difference",
        table(
            *("scenes", seeds, {f"{n}": n for n in (25, 100, 300)}),
            lambda scenes, s: (
                detection(scenes, Population(rate, 0.0, s, 0.5 * (s > 1)), ALPHA)
                for rate in (0.02, 0.1, 0.3)
            ),
        ),
    )
    yield "Audits of equal versions", announced
    heads = ("largest level", "largest to one side", "populations above .05")
    heads = (*heads, "above .025 to one side", "power, 3 seeds", "power, 1 seed")
    yield (
        "Skewed populations",
        lambda: markdown(
            heads, [[share([rate]) for rate in (*skewed(1000), powered(3), powered(1))]]
        ),
    )
    yield (
        "Many scenes",
        lambda: markdown(
            ("scenes", *(f"{level:g}".removeprefix("0") for level in LEVELS)),
            (
                (f"{n:,}", *(f"{largest_level(n, a):.5f}".removeprefix("0") for a in LEVELS))
                for n in SCENES
            ),
        ),
    )
    yield (
        "Intervals of skewed seeds",
        table(
            *("scenes", percent(LOST), {f"{n}": n for n in (50, 100, 300)}),
            lambda scenes, lost: (
                skewed_coverage(scenes, seeds, gains, lost)
                for seeds, gains in product((3, 5), (0.2, 0.9))
            ),
        ),
    )
    yield (
        "Missing trials",
        lambda: markdown(
            ("what is missing", "any difference", "any set is wrong"),
            merged((kind, rates) for (kind, _), rates in zip(BLANKS, missing(), strict=True)),
        ),
    )
    yield (
        "Reversals",
        table(
            "scenes, seeds",
            {"isolated effects 0": 0.0, "isolated effects 20 pp": 0.2},
            pairs((25, 100), (1, 3)),
            lambda size, effect: reversals(*size, effect),
        ),
    )
    failures = {
        "reversal": lambda failed: reversals(60, 3, 0.14, failed),
        "effect under another condition": beside_failures,
    }
    rows = percent((0.0, 0.01, 0.05))
    yield "Failed trials", table("trials that fail", failures, rows, lambda row, of: of(row))
    trained = {
        "new trainings": lambda s: trainings(100, s, True),
        "new and alike, six contrasts": lambda s: alike(100, s),
        "these trainings": lambda s: trainings(100, s, False),
        "new, one in ten collapses": lambda s: trainings(100, s, True, collapse=0.4),
    }
    yield (
        "Equal methods, other trainings",
        table("scenes, trainings", trained, {"100, 5": 5, "100, 10": 10}, lambda row, of: of(row)),
    )
    yield from scans.sections()


def announced() -> str:
    """Return the table of audits of equal versions: of fixed size, then sequential ones."""
    sizes = ((25, 1), (100, 1), (100, 3))
    rows = [
        (n, Population(rate, 0.0, seeds, 0.5)) for (n, seeds), rate in product(sizes, (0.05, 0.3))
    ]
    with ProcessPoolExecutor() as pool:
        columns = [
            pool.map(reported, *zip(*rows, strict=True), repeat(together))
            for reported, together in product((equal_variants, any_look), (0.0, 0.7))
        ]
        rates = list(zip(*columns, strict=True))
    heads = ("independent", "alike 70 %", "sequential, independent", "sequential, alike 70 %")
    return markdown(
        ("scenes, seeds", *heads),
        merged((f"{n}, {of.seeds}", row) for (n, of), row in zip(rows, rates, strict=True)),
    )


def missing(runs: int = 2000) -> Iterator[tuple[float, float]]:
    """Yield both shares of `blanks`, by its settings: most of the page's time, so in parallel."""
    with ProcessPoolExecutor() as pool:
        yield from pool.map(blanks, *zip(*BLANKS, strict=True), repeat(runs))


def main() -> None:
    """Write the page; its path is the argument. With titles of sections behind it, measure these
    alone and leave the others as they are on the page."""
    page, *titles = sys.argv[1:]
    lines = [
        "# Error rates by simulation",
        "",
        "Made by `make statistics`: the shipped code analyses populations with a known truth. "
        "Rates have a standard error of .003 (interval), .005 (break-even, audits of equal "
        "versions), .018 (sequential audits) and at most .020 (reversals, failed trials). "
        "[Design](design/statistics.md): what is promised, and by which tests.",
        "",
    ]
    measured_before = written(Path(page)) if titles else {}
    notes = yaml.safe_load(Path(__file__).with_name("simulation_notes.yaml").read_text("utf-8"))
    if unknown := set(titles) - {title for title, _ in sections()}:
        sys.exit(f"No section of the page is called {min(unknown)!r}: name one by its heading.")
    for title, measured in sections():
        if title in measured_before and title not in titles:
            lines += [measured_before[title], ""]
            continue
        print(title, file=sys.stderr, flush=True)
        lines += [f"## {title}", "", notes.get(title, ""), "", kept(title, measured), ""]
    Path(page).write_text("\n".join(lines).rstrip() + "\n", "utf-8")


if __name__ == "__main__":
    main()
