"""The tables of a self-check, for the terminal and for the page."""

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from rich.console import Console

from faultpath.selfcheck.audits import EQUAL, REVERSAL, TRAININGS
from faultpath.selfcheck.coverage import BREAK_EVEN, INTERVAL, MODELS
from faultpath.selfcheck.detection import DETECTION
from faultpath.selfcheck.model import Cell, Report
from faultpath.selfcheck.plane import CORRELATION, EQUAL_MAPS
from faultpath.tables import Table, line
from faultpath.tables.markdown import grid
from faultpath.tables.terminal import drawn

_FEW = (0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 1e9)
Texts: TypeAlias = tuple[str, ...]


@dataclass(frozen=True)
class Shown:
    """A table of one section: how its settings become rows."""

    section: str
    title: str
    note: str
    rows: Callable[[Sequence[Cell]], tuple[Texts, Iterable[Texts]]]
    """Headings, the first above the labels, and rows."""
    concerns: Callable[[Cell], bool] = lambda cell: True

    def table(self, report: Report) -> Table:
        """Return it for a report."""
        cells = [cell for cell in report.section(self.section).cells() if self.concerns(cell)]
        (corner, *columns), rows = self.rows(cells)
        lines = tuple(line(label, *texts) for label, *texts in rows)
        return Table(
            title=self.title,
            corner=corner,
            columns=tuple(columns),
            lines=lines,
            notes=(self.note,),
        )


def _across(
    corner: str, across: str, label: Callable[[Cell], str]
) -> Callable[[Sequence[Cell]], tuple[Texts, Iterable[Texts]]]:
    """Return rows of the range of rates by label, with a column for each value of `across`."""

    def made(cells: Sequence[Cell]) -> tuple[Texts, Iterable[Texts]]:
        values = sorted({float(cell[across]) for cell in cells})
        rows: dict[str, dict[float, list[float]]] = {}
        for cell in cells:
            at = rows.setdefault(label(cell), {})
            at.setdefault(float(cell[across]), []).append(float(cell["measured"]))
        heads = (corner, *(f"{100 * value:g} %" for value in values))
        return heads, [(name, *(_range(at[v]) for v in values)) for name, at in rows.items()]

    return made


def _each(
    heads: Texts, texts: Callable[[Cell], Texts]
) -> Callable[[Sequence[Cell]], tuple[Texts, Iterable[Texts]]]:
    """Return one row for each setting, its rate last."""
    return lambda cells: (heads, [(*texts(c), _share(float(c["measured"]))) for c in cells])


def _by_differing(cells: Sequence[Cell]) -> tuple[Texts, Iterable[Texts]]:
    rows: list[Texts] = []
    for low, high in itertools.pairwise(_FEW):
        rates = [float(c["measured"]) for c in cells if low <= float(c["differing"]) < high]
        if rates:
            name = f"{low:g} to {high:g}" if high < 1e9 else f"{low:g} and more"
            above = sum(rate > 0.98 for rate in rates)
            below = sum(rate < 0.93 for rate in rates)
            ends = _share(min(rates)), _share(max(rates))
            rows.append((name, str(len(rates)), *ends, f"{below}/{above}"))
    heads = ("differing scenes", "settings", "least", "greatest", "below .93 / above .98")
    return heads, rows


def _detection(cells: Sequence[Cell]) -> tuple[Texts, Iterable[Texts]]:
    kinds = dict.fromkeys((c["seeds"], c["alike"], c["alpha"]) for c in cells)
    found = {
        (c["scenes"], c["rate"], c["seeds"], c["alike"], c["alpha"]): float(c["measured"])
        for c in cells
    }
    rows = [
        (
            f"{n} scenes, {100 * float(rate):g} %",
            *(_share(found[(n, rate, *kind)]) for kind in kinds),
        )
        for n, rate in dict.fromkeys((c["scenes"], c["rate"]) for c in cells)
    ]
    heads = (
        f"{_seeds(seeds)}{', half alike' if alike else ''}, p ≤ {float(alpha):.3g}"
        for seeds, alike, alpha in kinds
    )
    return ("scenes, discordant", *heads), rows


TABLES = (
    Shown(
        INTERVAL,
        "Interval of an effect, one seed",
        "Coverage of the 95 % interval (Tango's), exact, by scenes, by how discordant scenes "
        "split, and by the share of scenes that is discordant. Promised: at least .93.",
        _across("scenes, split", "rate", lambda c: f"{c['scenes']}, {_LEANS[float(c['lean'])]}"),
        lambda c: c["seeds"] == 1,
    ),
    Shown(
        INTERVAL,
        "Interval of an effect, several seeds",
        "Least and greatest coverage over three splits, over seeds that are independent, half "
        "alike or copies of each other, without and with strong seed effects. Columns: share of "
        "discordant pairs of a seed, on average. Promised: at least .93.",
        _across("seeds, scenes", "rate", lambda c: f"{c['seeds']} seeds, {c['scenes']} scenes"),
        lambda c: c["seeds"] != 1,
    ),
    Shown(
        INTERVAL,
        "Where the interval covers more than it says",
        "All settings of both tables above, by the expected number of scenes that differ. At most "
        ".98 is not promised, because no interval of counts that tosses no coin can keep it there: "
        "with 25 scenes, of which 0.5 % are one-sidedly discordant, none, one or two differ with "
        "chances .882, .111 and .007, and no sum of these lies between .93 and .98. Whoever wants "
        ".93 at least gets .99 or 1.",
        _by_differing,
    ),
    Shown(
        MODELS,
        "Interval of an effect, newly trained models",
        "Coverage of the 95 % interval of `--generalise models`, the hull of score interval and "
        "crossed bootstrap. Only the first arm ever wins; half of the scenes treat all "
        "trainings alike. Columns: share of discordant pairs, on average over trainings. Promised: "
        "at least .93 where trainings do not differ. Where each has a rate of its own, anywhere "
        "from 0 to twice the average, nothing is promised: so few trainings do not show how far "
        "new ones may lie, and what is detected needs the t test of the seeds' effects as well.",
        _across(
            "trainings, scenes",
            "rate",
            lambda c: (
                f"{c['seeds']} trainings, {c['scenes']} scenes, "
                f"{'each its own rate' if c['own rates'] else 'one rate'}"
            ),
        ),
    ),
    Shown(
        BREAK_EVEN,
        "Break-even frequency",
        "Least and greatest coverage of the set of frequencies at which it is not decided who is "
        "ahead, over costs that are one-sided, in between or none on balance, gains of 5 and 30 "
        "pp under the fault, and seeds as above. Columns: share of scenes that differ under "
        "correct inputs. Promised: at least .93.",
        _across(
            "seeds, scenes", "cost rate", lambda c: f"{_seeds(c['seeds'])}, {c['scenes']} scenes"
        ),
    ),
    Shown(
        DETECTION,
        "Minimum detectable effect",
        "Audits of equal arms report what they could have detected; then the true difference is "
        "made that. Share of audits that detect it, averaged over what was reported; columns: "
        "seeds, and the level that the family leaves. Promised: .75 to .85 for one seed, at least "
        ".70 for several. With the discordance known it would be .80; it is estimated from the "
        "same audit, and one that saw too few discordant pairs promises too much. Where hardly "
        "a pair is discordant, nothing tells how seeds agree; all are then taken to end alike, "
        "which is cautious.",
        _detection,
    ),
    Shown(
        EQUAL,
        "Audits of equal arms",
        "Share of audits with four paths that announce anything at all: an effect, a change, a "
        "reversal. Paths alike: chance that a scene ends the same on all paths. Promised: at most "
        ".05.",
        _each(
            ("scenes", "seeds", "discordant", "paths alike", "announce"),
            lambda c: (
                str(c["scenes"]),
                str(c["seeds"]),
                f"{100 * float(c['rate']):g} %",
                f"{float(c['paths alike']):g}",
            ),
        ),
    ),
    Shown(
        REVERSAL,
        "Reversals",
        "Share of audits that announce a reversal where the shared effect is -20 pp. Where both "
        "isolated effects are 0 there is none; promised: at most .025. The others show the power.",
        _each(
            ("scenes", "seeds", "isolated effects, pp", "announce"),
            lambda c: (str(c["scenes"]), str(c["seeds"]), f"{float(c['isolated pp']):g}"),
        ),
    ),
    Shown(
        TRAININGS,
        "Equal methods, other trainings",
        "Two methods that are equal, of which every training is off by 8 pp (standard deviation). "
        "Share of audits that detect a difference. For newly trained models (`--generalise "
        "models`) that is an error, promised in at most .05; for these trained models it is not "
        "one: they do differ.",
        _each(
            ("speaks of", "scenes", "seeds", "detect"),
            lambda c: (
                f"{'new' if c['generalise'] == 'models' else 'these'} trainings",
                str(c["scenes"]),
                str(c["seeds"]),
            ),
        ),
    ),
    Shown(
        EQUAL_MAPS,
        "Maps of equal arms",
        "Share of reversal maps that announce anything, where the arms are equal at every pair of "
        "errors: at a place on the map, or at a correlation of the errors. Scenes alike: share "
        "that ends the same in both arms; waves: scenes in which places of the map depend on each "
        "other little. Promised: at most .05 each.",
        _each(
            ("of a", "scenes", "scenes alike", "announce"),
            lambda c: (str(c["of"]), str(c["scenes"]), str(c["alike"])),
        ),
    ),
    Shown(
        CORRELATION,
        "Break-even correlation",
        "Coverage of the set of correlations at which it is not decided who does better: of the "
        "true one of the surface that is straight between the points, and of the true one of the "
        "errors themselves. Promised: at least .93.",
        _each(
            ("truth", "scenes", "scenes alike", "coverage"),
            lambda c: (
                "of the surface" if c["straight"] else "of the errors",
                str(c["scenes"]),
                f"{float(c['alike']):g}",
            ),
        ),
    ),
)


def tables(report: Report) -> list[Table]:
    """Return all tables of a report."""
    names = {section.name for section in report.sections}
    return [shown.table(report) for shown in TABLES if shown.section in names]


def page(report: Report, broken: Sequence[str]) -> str:
    """Return the page that documents a report."""
    minutes = report.seconds / 60
    kept = ["No promise below is broken by more than three standard errors."]
    if broken:
        heading = "Promises broken by more than three standard errors:"
        kept = [heading, "", *(f"- {sentence}" for sentence in broken)]
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
        *kept,
        "",
    ]
    for table in tables(report):
        lines += [f"## {table.title}", "", *table.notes, "", grid(table), ""]
    return "\n".join(lines).rstrip() + "\n"


def show(report: Report, console: Console) -> None:
    """Print every table with its note."""
    for table in tables(report):
        console.print()
        console.print(drawn(table))
        console.print(*table.notes, markup=False)


def _error(report: Report, name: str) -> str:
    runs = max(float(cell["runs"]) for cell in report.section(name).cells())
    return f"{(0.05 * 0.95 / runs) ** 0.5:.3f}".lstrip("0")


def _range(rates: Iterable[float]) -> str:
    low, high = _share(min(rates := list(rates))), _share(max(rates))
    return low if low == high else f"{low}–{high}"


def _share(rate: float) -> str:
    text = f"{rate:.3f}"
    return text.removeprefix("0") if rate < 0.9995 else "1"


def _seeds(seeds: object) -> str:
    return f"{seeds} seed{'' if seeds == 1 else 's'}"


_LEANS = {0.0: "even", 0.5: "three to one", 1.0: "one-sided"}
