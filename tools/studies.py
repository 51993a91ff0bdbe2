"""Numbers and sentences of finished studies, as the templates of their pages show them."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml
from blocks import figures_of, load
from carry_design import Flown
from carry_verdicts import hours, lead, moves, overall, questions, reason, sentences, title
from state_design import Audit, SensorAudits

from faultpath.analyses.model import CORRECT, SHARED
from faultpath.core.text import counted, series

WORDS = yaml.safe_load(Path(__file__).with_name("audits.yaml").read_text("utf-8"))
CAMERA_PLACES, CAMERA_FAULTS = WORDS["camera_places"], WORDS["camera_faults"]
CAMERA_COMPARED = {place: words for place, words in CAMERA_PLACES.items() if place != "goal"}
"""Places of the page's table: a test of the live picture alone, and deployment."""


def camera(study: str, part: str) -> Any:
    """Return what a study of one camera left in a file."""
    return figures_of("latent-camera", f"{study}-{part}.json")


def camera_error(row: Mapping[str, Any], study: str) -> str:
    """Return the error of the camera in words, with the rooms where they are not the usual ones."""
    return f"{CAMERA_FAULTS[row['fault']]}{', blank rooms' * (study == 'blank')}"


def camera_success(study: str) -> list[dict[str, Any]]:
    """Return success of the baseline and of every repair, fault by fault and place by place."""
    rows: dict[tuple[str, str], dict[str, Any]] = {}
    for audit in camera(study, "held-out")["audits"]:
        for place, (repair, baseline) in audit["success"].items():
            fault = "" if place == "correct" else CAMERA_FAULTS[audit["fault"]]
            row = {"fault": fault, "place": CAMERA_PLACES[place], "repairs": {}}
            row = rows.setdefault((fault, place), row)
            row["plain"] = baseline
            row["repairs"][audit["repair"]] = repair
    return list(rows.values())


def camera_answer(names: Sequence[str]) -> str:
    """Return whether any audit of these studies has a reversal, and how both pictures compare with
    the live one alone."""
    studies = {name: camera(name, "held-out") for name in names}
    audits = [audit for study in studies.values() for audit in study["audits"]]
    turned = sum("reversal" in audit["turns"].values() for audit in audits)
    start = f"A reversal is significant in {turned} of" if turned else "No reversal in"
    lines = [
        f"{start} {counted(len(audits), 'audit')}. With the error in both pictures, compared with "
        "the live one alone, `plain` succeeds\n"
    ]
    for rooms in ("marked", "blank"):
        own = (study for name, study in studies.items() if (name == "blank") == (rooms == "blank"))
        rows = [row for study in own for row in study["baseline"]]
        faults = {
            words: [CAMERA_FAULTS[row["fault"]] for row in rows if row["effect"][3] == sign]
            for sign, words in WORDS["camera_signs"].items()
        }
        clauses = (f"{words} ({series(own)})" for words, own in faults.items() if own)
        lines.append(f"- in {rooms} rooms {', '.join(clauses)}.")
    return "\n".join(lines)


def sensors() -> SensorAudits:
    """Return the audits under sensors' faults."""
    return load("state-errors").record


def sensor_place(condition: str) -> str:
    """Return who gets the fault, in words."""
    places = {CORRECT: "no fault", SHARED: "at the sensor (shared)"}
    return places.get(condition, f"at the {condition}")


def sensor_places() -> dict[str, str]:
    """Return the conditions of the audits, without a fault and shared first, with their words."""
    conditions = (CORRECT, SHARED, *sensors().audits[0].turns)
    return {condition: sensor_place(condition) for condition in conditions}


def sensor_sentences(audits: Sequence[Audit]) -> list[str]:
    """Return in sentences what is significant when shared, what isolated tests show, the rest."""
    signs = {sign: [a for a in audits if a.effects[SHARED][3] == sign] for sign in (1, -1, 0)}
    shared = [*signs[1], *signs[-1]]
    sentences = [
        f"Of {counted(len(audits), 'audit')} with the fault at the sensor, the "
        f"repair succeeds significantly more often than the baseline in {_named(signs[1])} and "
        f"less often in {_named(signs[-1])}."
    ]
    if shared:
        tests = "; ".join(_isolated(shared, module) for module in shared[0].turns)
        sentences.append(f"Of these {counted(len(shared), 'difference')}, {tests}.")
    reversals = sum("reversal" in audit.turns.values() for audit in audits)
    start = f"A reversal was found in {reversals}"
    if not reversals:
        start = "No reversal was found, which does not show that there is none"
    return [*sentences, f"{start}; inconclusive with the fault at the sensor: {_named(signs[0])}."]


def _named(audits: Sequence[Audit]) -> str:
    names = [f"{audit.repair} under {audit.fault}" for audit in audits]
    return f"{len(audits)} ({series(names)})" if names else "none"


def _isolated(audits: Sequence[Audit], module: str) -> str:
    """Return in how many audits a test at one module shows what is significant when shared."""
    same = sum(a.effects[module][3] == a.effects[SHARED][3] for a in audits)
    differ = sum(a.turns.get(module, "none") != "none" for a in audits)
    return (
        f"a test {sensor_place(module)} alone shows {same or 'none'} "
        f"(significantly different from the shared effect: {differ or 'none'})"
    )


def carried(name: str) -> list[str]:
    """Return what is decided of each question of the study on other conditions, in sentences."""
    return sentences(load(name).record)


def carry_columns(name: str) -> Iterator[dict[str, Any]]:
    """Yield for each question with the fault at one place in how many cells who is ahead, the mean,
    and what each factor changes of it."""
    flown = load(name).record
    means = {title(question, reach): mean for question, reach, mean in overall(flown)}
    changes = moves(flown)
    for question, reach, cells in questions(flown):
        if cells:
            leads = [lead(flown.design, cell) for cell in cells]
            yield {
                "title": title(question, reach),
                "cells": len(cells),
                "repair": leads.count(1),
                "baseline": leads.count(-1),
                "at_an_end": sum(reason(cell) in ("floor", "ceiling") for cell in cells),
                "mean": means[title(question, reach)],
                "changes": {
                    f"{move.factor} {' → '.join(move.levels)}": move.change
                    for move in changes
                    if (move.question, move.reach) == (question, reach)
                },
            }


def minutes_on(flown: Flown, nodes: int) -> float:
    """Return the minutes that the study would take on so many nodes of two cores."""
    return 60 * hours(flown, nodes)
