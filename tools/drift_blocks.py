"""What `docs/drift-and-correlation.md` shows of the study of `drift_study.py`."""

from collections.abc import Callable, Mapping
from math import ceil
from pathlib import Path

import drift_study as study
from blocks import parsed, tabled
from drift_decided import CONSTANT, LAWS, Law, laws, lines, where
from flown_code import flown_by
from pictures import IMAGES

from faultpath import tables
from faultpath.record import RunProvenance
from faultpath.record.wording import p_value, plain, with_interval
from faultpath.record.words import capital
from faultpath.report.figures.effects import directions, mark
from faultpath.report.scale import covering, draw_uprights
from faultpath.report.svg import Svg
from faultpath.tables import MISSING, Entry, Table
from faultpath.tables.markdown import grid

PICTURE = IMAGES / "drift-L3.svg"
ABSENT = "*This study has not been flown yet: `python tools/drift_study.py`.*"
_WIDTH, _HEAD, _PITCH = 720.0, 34.0, 28.0


def table() -> str:
    """Return success and differences on all paths, with the change to full correlation."""
    asked, shown = study.design(), list[tables.Line]()
    heading = ""
    for each in lines():
        if each.law != heading:
            shown.append(tables.Line(label=each.law))
            heading = each.law
        shown.append(
            tables.line(
                capital(each.label),
                *map(plain, each.rates),
                Entry(text=with_interval(each.effect), detected=bool(each.sign)),
                each.counts,
                MISSING if each.p is None else p_value(each.p),
                Entry(
                    text=with_interval(each.change) if each.change else MISSING,
                    detected=bool(each.change_sign),
                ),
                MISSING if each.change_p is None else p_value(each.change_p),
            )
        )
    return grid(
        Table(
            corner="Error strikes",
            columns=(
                f"{asked.baseline}, %",
                f"{asked.repair}, %",
                "Difference, pp",
                "Won:lost",
                "p, Holm",
                "Change to correlation 1, pp",
                "p, Holm",
            ),
            lines=tuple(shown),
        )
    )


def words() -> str:
    """Return an item a law: all that was decided, and what could have been."""
    return "\n".join(f"- **{LAWS[law]}.** {_said(found)}" for law, found in laws().items())


def _said(law: Law) -> str:
    asked, said = study.design(), list[str]()
    for path, effect in law.family.effects.items():
        if effect.sign:
            winner = asked.repair if effect.sign > 0 else asked.baseline
            said.append(
                f"{capital(where(path))}: `{winner}` succeeds more often "
                f"({with_interval(effect.estimate())} pp)."
            )
    for path, change in law.family.changes.items():
        if change.sign:
            shown = law.family.turns[path] == "reversal"
            said.append(
                f"From {where(path)}, to both, correlation 1, the difference changes "
                f"({with_interval(change.estimate())} pp); a reversal is{'' if shown else ' not'} "
                "shown."
            )
    least = [found for path in law.family.effects if (found := law.detectable(path))]
    return (
        f"{' '.join(said)} Nothing else is decided, of {law.family.hypotheses} contrasts; true "
        f"effects of {ceil(min(least))} to {ceil(max(least))} pp, by path, would be found with "
        "80 % power."
    ).strip()


def origin() -> str:
    """Return what was flown, and by which code."""
    asked, held = study.design(), laws()
    made = parsed(study.FOLDER / "provenance.json", RunProvenance, "run tools/drift_study.py")
    scenes = next(iter(held.values())).found.scenes
    arms = 2 * (1 + len(held) * (len(asked.paths()) - 1))
    hypotheses = next(iter(held.values())).family.hypotheses
    return (
        f"{scenes} scenes of `{asked.library}`, wind L3, seed {asked.seed}, "
        f"{arms * scenes} trials. "
        f"Bold is decided: interval and test agree, and it stands after Holm's correction for the "
        f"{hypotheses} contrasts of its law. Intervals are for new scenes like these, for these "
        f"trained models. {flown_by(made, asked.system, asked.options)} The constant error is that "
        f"of the [main job](quadrotor.md), corrected in its own family."
    )


def law_table() -> str:
    """Return the laws of errors that were flown."""
    asked = study.design()
    size = f"{100 * asked.std:g} %"
    rows = [
        {"name": CONSTANT, "std": f"+{size} in every scene", "time": "never changes"},
        *(
            {
                "name": LAWS[law],
                "std": f"drawn, standard deviation {size}",
                "time": "drawn once, then constant"
                if seconds is None
                else f"wanders, correlation 1/e after {seconds:g} s",
            }
            for law, seconds in asked.laws.items()
        ),
    ]
    return tabled("Law", rows, {"Size": "{std}", "In flight": "{time}"})


def draw() -> str:
    """Return the picture: the success difference on each path, by law."""
    asked, drawn = study.design(), [line for line in lines() if line.law]
    groups = {
        law: [line for line in drawn if line.law == law] for law in (CONSTANT, *LAWS.values())
    }
    told = "; ".join(f"{e.law}, {e.label}: {with_interval(e.effect)} pp" for e in drawn)
    height = 40.0 + _HEAD * len(groups) + _PITCH * len(drawn)
    title = f"Success of {asked.repair} minus success of {asked.baseline}, percentage points"
    svg = Svg(_WIDTH, height + 40, title, told)
    ends = [end for e in drawn for end in (e.effect.value, e.effect.low, e.effect.high)]
    plot = covering([end for end in ends if end is not None], least=10.0).at(190, 560)
    directions(svg, plot, 14)
    draw_uprights(svg, plot, 26, height, 6)
    svg.text(375, height + 36, title.split(",")[0] + ", pp", "small soft", "middle")
    y = 40.0
    for law, rows in groups.items():
        svg.text(0, y + 10, law, "head")
        y += _HEAD
        for row in rows:
            svg.text(14, y + 4, row.label)
            mark(svg, plot, row.effect, y, row.sign, None)
            svg.text(_WIDTH, y + 4, with_interval(row.effect), "bold" if row.sign else "", "end")
            y += _PITCH
    return svg.render(standalone=True)


def picture() -> str:
    """Return the link to the picture, with what it shows in words."""
    return (
        "![Success difference between the two reconstructions, by the law of the error and by how "
        f"far the modules share it; filled marks are decided]({{images}}/{PICTURE.name})"
    )


def pictures() -> Mapping[Path, str]:
    """Return the picture by its path; nothing without the study."""
    return {PICTURE: draw() + "\n"} if laws() else {}


def _when_flown(fill: Callable[[], str]) -> Callable[[], str]:
    return lambda: fill() if laws() else ABSENT


KIND: Mapping[str, Callable[[], str]] = {
    "laws": law_table,
    "table": _when_flown(table),
    "words": _when_flown(words),
    "origin": _when_flown(origin),
    "picture": _when_flown(picture),
}
"""What fills the blocks of the page."""
