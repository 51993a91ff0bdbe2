"""How each table of a self-check is worded."""

import itertools
from collections.abc import Iterable, Sequence

from faultpath.selfcheck.audits import EQUAL, REVERSAL, TRAININGS
from faultpath.selfcheck.coverage import BREAK_EVEN, INTERVAL, MODELS
from faultpath.selfcheck.detection import DETECTION
from faultpath.selfcheck.model import Cell
from faultpath.selfcheck.plane import CORRELATION, EQUAL_MAPS, PLACES, TURNS, TURNS_FOUND
from faultpath.selfcheck.record_words import RECORDS
from faultpath.selfcheck.rows import LEANS, Shown, Texts, across, each, of_seeds, share
from faultpath.selfcheck.sequential import ANY_LOOK, AT_ODDS, DECIDED, EVERY_LOOK, TAKEN

_FEW = (0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 1e9)


def _by_differing(cells: Sequence[Cell]) -> tuple[Texts, Iterable[Texts]]:
    rows: list[Texts] = []
    for low, high in itertools.pairwise(_FEW):
        rates = [float(c["measured"]) for c in cells if low <= float(c["differing"]) < high]
        if rates:
            name = f"{low:g} to {high:g}" if high < 1e9 else f"{low:g} and more"
            above = sum(rate > 0.98 for rate in rates)
            below = sum(rate < 0.93 for rate in rates)
            ends = share(min(rates)), share(max(rates))
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
            *(share(found[(n, rate, *kind)]) for kind in kinds),
        )
        for n, rate in dict.fromkeys((c["scenes"], c["rate"]) for c in cells)
    ]
    heads = (
        f"{of_seeds(seeds)}{', half alike' if alike else ''}, p ≤ {float(alpha):.3g}"
        for seeds, alike, alpha in kinds
    )
    return ("scenes, discordant", *heads), rows


def _difference(cell: Cell) -> Texts:
    label = f"{100 * float(cell['rate']):g} %, {float(cell['difference pp']):g} pp"
    return label, str(cell["fixed scenes"])


TABLES = (
    Shown(
        INTERVAL,
        "Interval of an effect, one seed",
        "Coverage of the 95 % interval (Tango's), exact, by scenes, by how discordant scenes "
        "split, and by the share of scenes that is discordant. Promised: at least .93.",
        across("scenes, split", "rate", lambda c: f"{c['scenes']}, {LEANS[float(c['lean'])]}"),
        lambda c: c["seeds"] == 1,
    ),
    Shown(
        INTERVAL,
        "Interval of an effect, several seeds",
        "Least and greatest coverage over three splits, over seeds that are independent, half "
        "alike or copies of each other, without and with strong seed effects. Columns: share of "
        "discordant pairs of a seed, on average. Promised: at least .93.",
        across("seeds, scenes", "rate", lambda c: f"{c['seeds']} seeds, {c['scenes']} scenes"),
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
        "Student's t over trainings. Only the first arm ever wins; half of the scenes treat all "
        "trainings alike. Columns: share of discordant pairs, on average over trainings. Promised: "
        "at least .93 where trainings do not differ, and .90 where each has a rate of its own, "
        "anywhere from 0 to twice the average: scenes that treat all trainings alike vary too.",
        across(
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
        across(
            "seeds, scenes", "cost rate", lambda c: f"{of_seeds(c['seeds'])}, {c['scenes']} scenes"
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
        each(
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
        "isolated effects are 0 there is none; promised: at most .015. The others show the power.",
        each(
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
        each(
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
        each(
            ("of a", "scenes", "scenes alike", "announce"),
            lambda c: (str(c["of"]), str(c["scenes"]), str(c["alike"])),
        ),
    ),
    Shown(
        PLACES,
        "Decided places of a map",
        "Share of maps in which the side that is decided is the true one at every place of the "
        "map, flown or between. Promised: at least .95 of the surface that is straight between the "
        "points; nothing of the errors themselves, which bend between them.",
        each(
            ("truth", "scenes", "scenes alike", "all true"),
            lambda c: (
                "of the surface" if c["straight"] else "of the errors",
                str(c["scenes"]),
                f"{float(c['alike']):g}",
            ),
        ),
    ),
    Shown(
        CORRELATION,
        "Break-even correlation",
        "Coverage of the set of correlations at which it is not decided who does better: of the "
        "true one of the surface that is straight between the points, and of the true one of the "
        "errors themselves. Promised: at least .93.",
        each(
            ("truth", "scenes", "scenes alike", "coverage"),
            lambda c: (
                "of the surface" if c["straight"] else "of the errors",
                str(c["scenes"]),
                f"{float(c['alike']):g}",
            ),
        ),
    ),
    Shown(
        TURNS,
        "What a map says of its paths",
        "Share of maps in which all that is announced of the six half-lines is true: who is ahead "
        "up to the size before the turn, and who from the size after it on. Promised: at least "
        ".95 of the surface that is straight between the points; what that misses of the errors "
        "themselves no interval holds.",
        each(
            ("truth", "scenes", "scenes alike", "all true"),
            lambda c: (
                "of the surface" if c["straight"] else "of the errors",
                str(c["scenes"]),
                f"{float(c['alike']):g}",
            ),
        ),
    ),
    Shown(
        TURNS_FOUND,
        "Turning sizes that are found",
        "Of these maps, the share that decides both who is ahead under correct inputs (the "
        "baseline, by 10 pp) and that a larger error at the second module turns it, which is so. "
        "Nothing is promised: this is power.",
        each(
            ("scenes", "scenes alike", "turn found"),
            lambda c: (str(c["scenes"]), f"{float(c['alike']):g}"),
        ),
    ),
    *RECORDS,
    Shown(
        ANY_LOOK,
        "Sequential audits of equal arms",
        "Share of sequential audits with four paths that announce anything at any of ten "
        "looks, by the code that decides. Promised: at most .05.",
        each(
            ("at most scenes", "seeds", "discordant", "paths alike", "announce"),
            lambda c: (
                str(c["scenes"]),
                str(c["seeds"]),
                f"{100 * float(c['rate']):g} %",
                f"{float(c['paths alike']):g}",
            ),
        ),
    ),
    Shown(
        AT_ODDS,
        "Sequential p-values and intervals",
        "Share of the same audits in which, at any look, the p of the primary contrast is at most "
        ".05 and its 95 % interval holds 0, or the other way round. Promised: none.",
        each(
            ("at most scenes", "seeds", "discordant", "paths alike", "at odds"),
            lambda c: (
                str(c["scenes"]),
                str(c["seeds"]),
                f"{100 * float(c['rate']):g} %",
                f"{float(c['paths alike']):g}",
            ),
        ),
    ),
    Shown(
        EVERY_LOOK,
        "Confidence sequence of an effect",
        "Share of sequential audits whose 95 % confidence sequence holds the truth after every "
        "one of 300 scenes; where an audit stops, for whatever reason, it then does so at least as "
        "often. Columns: share of discordant pairs of a seed. Promised: at least .95.",
        across(
            "seeds, split", "rate", lambda c: f"{of_seeds(c['seeds'])}, {LEANS[float(c['lean'])]}"
        ),
    ),
    Shown(
        TAKEN,
        "Scenes that sequential audits take",
        "A true difference, one seed, six contrasts, a look after every scene. Fixed: scenes with "
        "which an audit of a fixed number detects it in 90 % of cases, to know which takes knowing "
        "discordance and difference beforehand. A sequential audit may take as many; it takes that "
        "share of them on average, and what it decides by then is in the next table. Nothing is "
        "promised.",
        each(("discordant, difference", "fixed scenes", "share taken"), _difference),
    ),
    Shown(
        DECIDED,
        "What sequential audits decide with that",
        "Share of the same audits that decide. With a fixed number of scenes it is .90.",
        each(("discordant, difference", "at most scenes", "decide"), _difference),
    ),
)
