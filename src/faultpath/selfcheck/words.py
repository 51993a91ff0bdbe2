"""The tables of a self-check, for the terminal and for the page."""

import itertools
from collections.abc import Callable, Iterable, Sequence

from faultpath.selfcheck.audits import EQUAL, REVERSAL, TRAININGS
from faultpath.selfcheck.coverage import BREAK_EVEN, INTERVAL, MODELS
from faultpath.selfcheck.detection import DETECTION
from faultpath.selfcheck.model import Report
from faultpath.selfcheck.promises import Cell
from faultpath.tables import Table, line
from faultpath.tables.markdown import grid

_FEW = (0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 1e9)


def tables(report: Report) -> list[Table]:
    """Return all tables of a report."""
    interval = report.section(INTERVAL).cells()
    return [
        _one_seed(interval),
        _several_seeds(interval),
        _by_differing(interval),
        _models(report.section(MODELS).cells()),
        _break_even(report.section(BREAK_EVEN).cells()),
        _detection(report.section(DETECTION).cells()),
        _equal(report.section(EQUAL).cells()),
        _reversal(report.section(REVERSAL).cells()),
        _trainings(report.section(TRAININGS).cells()),
    ]


def page(report: Report, broken: Sequence[str]) -> str:
    """Return the page that documents a report."""
    minutes = report.seconds / 60
    lines = [
        "# What the statistics keep",
        "",
        f"Made by `faultpath selfcheck statistics`, profile {report.profile}, in {minutes:.0f} "
        "minutes; the numbers are in [reference/statistics-check.json]"
        "(reference/statistics-check.json). Populations with a known truth are sampled, and the "
        "shipped code decides. Simulated rates have a standard error of "
        f"{_error(report, INTERVAL)} (interval), {_error(report, BREAK_EVEN)} (break-even), at "
        f"most {_error(report, EQUAL)} (audits) and {_error(report, MODELS)} (newly trained "
        "models); those of one seed are exact, but for break-even and audits.",
        "",
        "What is promised, and how it is decided: [design/statistics.md](design/statistics.md).",
        "",
    ]
    if broken:
        lines += [
            "Promises broken by more than three standard errors:",
            "",
            *(f"- {line}" for line in broken),
            "",
        ]
    else:
        lines += ["No promise below is broken by more than three standard errors.", ""]
    for table in tables(report):
        lines += [f"## {table.title}", "", *table.notes, "", grid(table), ""]
    return "\n".join(lines).rstrip() + "\n"


def _table(title: str, note: str, columns: Sequence[str], rows: Iterable[tuple[str, ...]]) -> Table:
    """Return a table; the first of `columns` heads the labels."""
    return Table(
        title=title,
        corner=columns[0],
        columns=tuple(columns[1:]),
        lines=tuple(line(label, *texts) for label, *texts in rows),
        notes=(note,),
    )


def _error(report: Report, name: str) -> str:
    runs = max(float(cell["runs"]) for cell in report.section(name).cells())
    return f"{(0.05 * 0.95 / runs) ** 0.5:.3f}".lstrip("0")


def _one_seed(cells: Sequence[Cell]) -> Table:
    rates, rows = _grid(
        [cell for cell in cells if cell["seeds"] == 1],
        lambda c: (f"{c['scenes']}, {_lean(float(c['lean']))}",),
        "rate",
    )
    return _table(
        "Interval of an effect, one seed",
        "Coverage of the 95 % interval (Tango's), exact, by scenes, by how discordant scenes "
        "split, and by the share of scenes that is discordant. Promised: at least .93.",
        ("scenes, split", *rates),
        rows,
    )


def _several_seeds(cells: Sequence[Cell]) -> Table:
    rates, rows = _grid(
        [cell for cell in cells if cell["seeds"] != 1],
        lambda c: (f"{c['seeds']} seeds, {c['scenes']} scenes",),
        "rate",
    )
    return _table(
        "Interval of an effect, several seeds",
        "Least and greatest coverage over three splits, over seeds that are independent, half "
        "alike or copies of each other, without and with strong seed effects. Columns: share of "
        "discordant pairs of a seed, on average. Promised: at least .93.",
        ("seeds, scenes", *rates),
        rows,
    )


def _by_differing(cells: Sequence[Cell]) -> Table:
    rows: list[tuple[str, ...]] = []
    for low, high in itertools.pairwise(_FEW):
        rates = [float(c["measured"]) for c in cells if low <= float(c["differing"]) < high]
        if rates:
            name = f"{low:g} to {high:g}" if high < 1e9 else f"{low:g} and more"
            above = sum(rate > 0.98 for rate in rates)
            below = sum(rate < 0.93 for rate in rates)
            rows.append(
                (name, str(len(rates)), _share(min(rates)), _share(max(rates)), f"{below}/{above}")
            )
    return _table(
        "Where the interval covers more than it says",
        "All settings of both tables above, by the expected number of scenes that differ. At most "
        ".98 is not promised, because no interval of counts that tosses no coin can keep it there: "
        "with 25 scenes, of which 0.5 % are one-sidedly discordant, none, one or two differ with "
        "chances .882, .111 and .007, and no sum of these lies between .93 and .98. Whoever wants "
        ".93 at least gets .99 or 1.",
        ("differing scenes", "settings", "least", "greatest", "below .93 / above .98"),
        tuple(rows),
    )


def _models(cells: Sequence[Cell]) -> Table:
    rates, rows = _grid(
        cells,
        lambda c: (
            f"{c['seeds']} trainings, {c['scenes']} scenes, "
            f"{'each its own rate' if c['own rates'] else 'one rate'}",
        ),
        "rate",
    )
    return _table(
        "Interval of an effect, newly trained models",
        "Coverage of the 95 % interval of `--generalise models`, the hull of score interval and "
        "crossed bootstrap. Only the first arm ever wins; half of the scenes treat all "
        "trainings alike. Columns: share of discordant pairs, on average over trainings. Promised: "
        "at least .93 where trainings do not differ. Where each has a rate of its own, anywhere "
        "from 0 to twice the average, nothing is promised: so few trainings do not show how far "
        "new ones may lie, and what is detected needs the t test of the seeds' effects as well.",
        ("trainings, scenes", *rates),
        rows,
    )


def _break_even(cells: Sequence[Cell]) -> Table:
    rates, rows = _grid(
        cells,
        lambda c: (f"{c['seeds']} seed{'s' if c['seeds'] != 1 else ''}, {c['scenes']} scenes",),
        "cost rate",
    )
    return _table(
        "Break-even frequency",
        "Least and greatest coverage of the set of frequencies at which it is not decided who is "
        "ahead, over costs that are one-sided, in between or none on balance, gains of 5 and 30 "
        "pp under the fault, and seeds as above. Columns: share of scenes that differ under "
        "correct inputs. Promised: at least .93.",
        ("seeds, scenes", *rates),
        rows,
    )


def _detection(cells: Sequence[Cell]) -> Table:
    kinds = dict.fromkeys((c["seeds"], c["alike"], c["alpha"]) for c in cells)
    found = {
        (c["scenes"], c["rate"], c["seeds"], c["alike"], c["alpha"]): float(c["measured"])
        for c in cells
    }
    rows = tuple(
        (
            f"{n} scenes, {100 * float(rate):g} %",
            *(_share(found[(n, rate, *kind)]) for kind in kinds),
        )
        for n, rate in dict.fromkeys((c["scenes"], c["rate"]) for c in cells)
    )
    heads = tuple(
        f"{seeds} seed{'s' if seeds != 1 else ''}"
        f"{', half alike' if alike else ''}, p ≤ {float(alpha):.3g}"
        for seeds, alike, alpha in kinds
    )
    return _table(
        "Minimum detectable effect",
        "Audits of equal arms report what they could have detected; then the true difference is "
        "made that. Share of audits that detect it, averaged over what was reported; columns: "
        "seeds, and the level that the family leaves. Promised: .75 to .85 for one seed, at least "
        ".70 for several. With the discordance known it would be .80; it is estimated from the "
        "same audit, and one that saw too few discordant pairs promises too much. Where hardly "
        "a pair is discordant, nothing tells how seeds agree; all are then taken to end alike, "
        "which is cautious.",
        ("scenes, discordant", *heads),
        rows,
    )


def _equal(cells: Sequence[Cell]) -> Table:
    return _table(
        "Audits of equal arms",
        "Share of audits with four paths that announce anything at all: an effect, a change, a "
        "reversal. Paths alike: chance that a scene ends the same on all paths. Promised: at most "
        ".05.",
        ("scenes", "seeds", "discordant", "paths alike", "announce"),
        tuple(
            (
                str(c["scenes"]),
                str(c["seeds"]),
                f"{100 * float(c['rate']):g} %",
                f"{float(c['paths alike']):g}",
                _share(float(c["measured"])),
            )
            for c in cells
        ),
    )


def _reversal(cells: Sequence[Cell]) -> Table:
    return _table(
        "Reversals",
        "Share of audits that announce a reversal where the shared effect is -20 pp. Where both "
        "isolated effects are 0 there is none; promised: at most .025. The others show the power.",
        ("scenes", "seeds", "isolated effects, pp", "announce"),
        tuple(
            (
                str(c["scenes"]),
                str(c["seeds"]),
                f"{float(c['isolated pp']):g}",
                _share(float(c["measured"])),
            )
            for c in cells
        ),
    )


def _trainings(cells: Sequence[Cell]) -> Table:
    return _table(
        "Equal methods, other trainings",
        "Two methods that are equal, of which every training is off by 8 pp (standard deviation). "
        "Share of audits that detect a difference. For newly trained models (`--generalise "
        "models`) that is an error, promised in at most .05; for these trained models it is not "
        "one: they do differ.",
        ("speaks of", "scenes", "seeds", "detect"),
        tuple(
            (
                "new trainings" if c["generalise"] == "models" else "these trainings",
                str(c["scenes"]),
                str(c["seeds"]),
                _share(float(c["measured"])),
            )
            for c in cells
        ),
    )


def _grid(
    cells: Sequence[Cell], label: Callable[[Cell], tuple[str, ...]], across: str
) -> tuple[tuple[str, ...], tuple[tuple[str, ...], ...]]:
    """Return headings and rows: the range of rates by label and by the column `across`."""
    rates = sorted({float(cell[across]) for cell in cells})
    rows: dict[tuple[str, ...], dict[float, list[float]]] = {}
    for cell in cells:
        at = rows.setdefault(label(cell), {})
        at.setdefault(float(cell[across]), []).append(float(cell["measured"]))
    heads = tuple(f"{100 * rate:g} %" for rate in rates)
    return heads, tuple((*name, *(_range(at[rate]) for rate in rates)) for name, at in rows.items())


def _range(rates: Iterable[float]) -> str:
    low, high = _share(min(rates := list(rates))), _share(max(rates))
    return low if low == high else f"{low}–{high}"


def _share(rate: float) -> str:
    text = f"{rate:.3f}"
    return text.removeprefix("0") if rate < 0.9995 else "1"


def _lean(lean: float) -> str:
    return {0.0: "even", 0.5: "three to one", 1.0: "one-sided"}[lean]
