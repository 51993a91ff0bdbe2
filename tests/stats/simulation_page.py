"""The page of `make statistics`: every promise of the statistics, measured."""

import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from itertools import product, repeat
from pathlib import Path

import simulation_scan as scans
from simulation import (
    LEANS,
    RATES,
    Population,
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
from simulation_tables import Section, kept, markdown, share, written

from faultpath.analyses.family import ALPHA

LOST = (0.005, 0.01, 0.02, 0.05)
"""Shares of scenes that lose all seeds."""


def sections() -> Iterator[Section]:
    """Yield everything that is measured."""
    by_rate = [f"{100 * rate:g} %" for rate in RATES]
    kinds = [(seeds, alike, own) for seeds in (3, 5) for alike in (0.0, 0.5) for own in (0, 1)]

    def structured(rate: float, lean: float, seeds: int) -> list[Population]:
        mine = [each for each in kinds if each[0] == seeds] or [(1, 0.0, 0)]
        return [Population(rate, lean, n, alike, bool(own)) for n, alike, own in mine]

    yield (
        "Interval of an effect",
        "Least and greatest coverage of the 95 % interval, over even and one-sided splits of the "
        "scenes that differ, and over seeds that are independent or half alike, without and with "
        "seed effects; exact for one seed. Columns: share of scenes that differ. Promised: at "
        "least .93. Where few scenes differ no interval of counts can keep .95: it covers more.",
        lambda: markdown(
            ("scenes, seeds", *by_rate),
            (
                (
                    f"{n}, {seeds}",
                    *(
                        share(
                            interval_coverage(n, truth)
                            for lean in LEANS
                            for truth in structured(rate, lean, seeds)
                        )
                        for rate in RATES
                    ),
                )
                for n, seeds in product((10, 25, 50, 100, 300), (1, 3, 5))
            ),
        ),
    )
    yield (
        "Break-even frequency",
        "Least and greatest coverage of the set of frequencies at which neither version is "
        "significantly ahead, over costs that are one-sided or in between and gains of 5 and 30 pp "
        "under the fault. Columns: share of scenes that differ under correct inputs. Promised: at "
        "least .93.",
        lambda: markdown(
            ("scenes, seeds", *by_rate),
            (
                (
                    f"{n}, {seeds}",
                    *(
                        share(
                            break_even_coverage(n, cost, replace(cost, rate=gain, lean=1.0))
                            for lean, gain in product((0.5, 1.0), (0.05, 0.3))
                            for cost in structured(rate, -lean, seeds)
                            if cost.mean <= 0.0
                        )
                        for rate in RATES
                    ),
                )
                for n, seeds in product((25, 100, 300), (1, 3))
            ),
        ),
    )
    yield (
        "Least detectable difference",
        "Audits of two equal versions report the difference that they would find with 80 % "
        "probability; then the true difference is made that. Share of audits in which it is "
        "significant. Promised: about .80, at least .70.",
        lambda: markdown(
            ("scenes, share that differs", "1 seed", "3 seeds"),
            (
                (
                    f"{n}, {100 * rate:g} %",
                    *(
                        share([detection(n, Population(rate, 0.0, s, 0.5 * (s > 1)), ALPHA)])
                        for s in (1, 3)
                    ),
                )
                for n, rate in product((25, 100, 300), (0.02, 0.1, 0.3))
            ),
        ),
    )
    for title, what, found in (
        ("Audits of equal versions", "four conditions", equal_variants),
        ("Sequential audits of equal versions", "four conditions and ten looks", any_look),
    ):
        yield (
            title,
            f"Share of audits with {what} that report any difference. Conditions alike: chance "
            "that a scene ends the same under all conditions. Promised: at most .05.",
            partial(announced, found),
        )
    yield (
        "Skewed populations",
        "A thousand populations of 25 to 300 scenes, two to five seeds and no difference, that "
        "differ otherwise to one side than to the other (as many by little as few by much), and a "
        "grid of those in which some scenes gain part of the seeds and few lose all. Share of "
        "audits under one condition that report a difference, promised: at most .05; and that "
        "report one to the worse side, which is a false reversal where an isolated fault certainly "
        "favours the other version, promised: at most .025; both but for a standard error of .001. "
        "The power is that at 100 scenes and three seeds, of which half of the scenes agree, where "
        "5.4 % of trials favour one version and .6 % the other.",
        lambda: markdown(
            (
                "largest level",
                "largest to one side",
                "populations above .05",
                "above .025 to one side",
                "power, 3 seeds",
                "power, 1 seed",
            ),
            ((share([rate]) for rate in (*skewed(1000), powered(3), powered(1))),),
        ),
    )
    yield (
        "Many scenes",
        "Above 1,000 scenes the E step of one seed's test is approximated. Largest chance, "
        "computed, that the test of two equal versions reports a difference, over all shares of "
        "scenes that differ. Columns: level. Promised: at most that level.",
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
        "Coverage of the 95 % interval where a share of the scenes gains one seed and a few lose "
        "all: what no scene showed may be a whole difference. Columns: share that loses all. "
        "Promised: at least .93.",
        lambda: markdown(
            ("scenes, seeds, share that gains", *(f"{100 * lost:g} %" for lost in LOST)),
            (
                (
                    f"{n}, {seeds}, {100 * gains:g} %",
                    *(share([skewed_coverage(n, seeds, gains, lost)]) for lost in LOST),
                )
                for n, seeds, gains in product((50, 100, 300), (3, 5), (0.2, 0.9))
            ),
        ),
    )
    yield (
        "Missing trials",
        "Two equal versions under three conditions, of which trials are missing that ended badly "
        "(one-sided: those of one version; opposite: of one version those that succeeded, of the "
        "other those that did not; repeated: of one seed of three that end alike; clustered: tasks "
        "of five scenes, half of the tasks with one less). Share of results that report any "
        "difference, promised: at most .05. Where the versions differ, share in which any of five "
        "break-even sets puts a version ahead where the other one is. 2,000 results each, with a "
        "standard error of at most .005. Both: both versions die, in 60 % of the scenes that only "
        "the baseline would solve and in 5 % of the others.",
        lambda: markdown(
            ("what is missing, seeds", "any difference", "any set is wrong"),
            (
                (f"{kind}, {seeds}", *(share([rate]) for rate in rates))
                for (kind, seeds), rates in zip(BLANKS, missing(), strict=True)
            ),
        ),
    )
    yield (
        "Reversals",
        "Share of audits that report a reversal where the shared effect is -20 pp. Where both "
        "isolated effects are 0 there is none; promised: at most .025, half of the 5 %, "
        "since the other half lies on the same side. The others show the power.",
        lambda: markdown(
            ("scenes, seeds", "isolated effects 0", "isolated effects 20 pp"),
            (
                (f"{n}, {s}", *(share([reversals(n, s, pp)]) for pp in (0.0, 0.2)))
                for n, s in product((25, 100), (1, 3))
            ),
        ),
    )
    yield (
        "Failed trials",
        "Share of audits of 60 scenes and three seeds that report a reversal, with isolated "
        "effects of 14 pp and a shared one of -20 pp, where a share of all trials fails by chance: "
        "what is significant has to be so whatever these would have been. And power for an effect "
        "of 12 pp where trials fail under another condition alone, which costs it next to nothing.",
        lambda: markdown(
            ("trials that fail", "reversal", "effect under another condition"),
            (
                (
                    f"{100 * failed:g} %",
                    share([reversals(60, 3, 0.14, failed)]),
                    share([beside_failures(failed)]),
                )
                for failed in (0.0, 0.01, 0.05)
            ),
        ),
    )
    yield (
        "Equal methods, other trainings",
        "Two equal methods, of which every training is off by 8 pp (standard deviation). Share of "
        "audits that report a difference. For newly trained models that is an error, promised in "
        "at most .05 where trainings spread as a Gaussian does; for these trained models it is not "
        "one: they do differ. The last column is what no interval can keep, and the result says "
        "so: one training in ten loses 40 pp and the others gain 4.4.",
        lambda: markdown(
            ("scenes, trainings", "new trainings", "these trainings", "new, one in ten collapses"),
            (
                (
                    f"100, {s}",
                    *(share([trainings(100, s, m)]) for m in (True, False)),
                    share([trainings(100, s, True, collapse=0.4)]),
                )
                for s in (5, 10)
            ),
        ),
    )
    yield from scans.sections()


def announced(found: Callable[[int, Population, float], float]) -> str:
    """Return the table of audits of equal versions, of which `found` measures one entry."""
    sizes = ((25, 1), (100, 1), (100, 3))
    rows = [
        (n, Population(rate, 0.0, seeds, 0.5)) for (n, seeds), rate in product(sizes, (0.05, 0.3))
    ]
    with ProcessPoolExecutor() as pool:
        apart, alike = (
            pool.map(found, *zip(*rows, strict=True), repeat(together)) for together in (0.0, 0.7)
        )
        rates = list(zip(apart, alike, strict=True))
    return markdown(
        ("scenes, seeds, share that differs", "conditions independent", "conditions alike 70 %"),
        (
            (f"{n}, {truth.seeds}, {100 * truth.rate:g} %", *(share([rate]) for rate in both))
            for (n, truth), both in zip(rows, rates, strict=True)
        ),
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
        "# What the statistics keep",
        "",
        "Made by `make statistics`: the shipped code analyses populations with a known truth. "
        "Simulated rates have a standard error of .003 (interval), .005 (break-even, audits of "
        "equal versions), .018 (sequential audits) and at most .020 (reversals, failed trials). "
        "What is promised, and by which tests: "
        "[design/statistics.md](design/statistics.md).",
        "",
    ]
    measured_before = written(Path(page)) if titles else {}
    if unknown := set(titles) - {title for title, *_ in sections()}:
        sys.exit(f"No section of the page is called {min(unknown)!r}: name one by its heading.")
    for title, note, measured in sections():
        if title in measured_before and title not in titles:
            lines += [measured_before[title], ""]
            continue
        print(title, file=sys.stderr, flush=True)
        lines += [f"## {title}", "", note, "", kept(title, measured), ""]
    Path(page).write_text("\n".join(lines).rstrip() + "\n", "utf-8")


if __name__ == "__main__":
    main()
