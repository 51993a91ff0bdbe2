"""Blocks of the page about a latent world model with one camera."""

from collections.abc import Mapping, Sequence
from typing import Any

from blocks import effect_entry, figures_of, words_grid

from faultpath.analyses.sentences import wording
from faultpath.analyses.sentences.wording import counted
from faultpath.analyses.tables import MISSING, Line, line

SHARED, ALONE = "shared", "observation"
CONDITIONS = {
    "correct": "no fault",
    ALONE: "live picture alone",
    "goal": "picture of the goal alone",
    SHARED: "both pictures",
}
FAULTS = {
    "darker": "15 % darker",
    "contrast": "gamma 1.3 times as large",
    "moved": "shifted by 2 px",
    "drifting": "drifting to 30 % darker",
    "smeared": "smeared by 6 px",
}
MISSED = {
    "missed_correct_px": "nearest place misses, no error, px",
    "missed_observation_px": "live picture alone, px",
    "missed_shared_px": "both pictures, px",
}
IMAGINED = {
    "imagined_correct": "an imagined action misses, no error, actions",
    "imagined_error": "with the error, actions",
}
COMPARED = {
    1: "significantly more often",
    -1: "significantly less often",
    0: "without a significant difference",
}


def _read(name: str) -> Any:
    return figures_of("latent-camera", f"{name}.json")


def _percent(share: float) -> str:
    return wording.plain(100 * share, 1)


def audits_of(rooms: str) -> list[dict[str, Any]]:
    """Return every audit on the scenes held out: fault, repair, effects and turns."""
    return _read(f"{rooms}-held-out")["audits"]


def success(rooms: str) -> str:
    """Return success of every variant in percent, fault by fault and condition by condition."""
    audits = audits_of(rooms)
    repairs = list(dict.fromkeys(audit["repair"] for audit in audits))
    rates: dict[tuple[str, str], dict[str, float]] = {}
    for audit in audits:
        for condition, (repair, baseline) in audit["success"].items():
            row = rates.setdefault(
                (audit["fault"] if condition != "correct" else "", condition), {}
            )
            row |= {"plain": baseline, audit["repair"]: repair}
    lines = [
        line(
            FAULTS.get(fault, ""),
            CONDITIONS[condition],
            *(_percent(row[n]) for n in ("plain", *repairs)),
        )
        for (fault, condition), row in rates.items()
    ]
    return words_grid("error of the camera", ("in", "plain", *repairs), lines)


def cancelled(*names: str) -> str:
    """Return whether an error in both pictures costs the baseline less than in the live one."""
    lines: list[Line] = []
    for name in names:
        for row in _read(f"{name}-held-out")["baseline"]:
            rates = map(_percent, reversed(row["success"]))
            lines.append(line(_error(row, name), *rates, effect_entry(row["effect"])))
    columns = (f"{CONDITIONS[ALONE]}, %", f"{CONDITIONS[SHARED]}, %", "difference, pp")
    return words_grid("error of the camera", columns, lines)


def effects(*names: str) -> str:
    """Return repair minus baseline, study by study, audit by audit and condition by condition."""
    lines: list[Line] = []
    for name in names:
        for audit in audits_of(name):
            differences = (effect_entry(audit["effects"][condition]) for condition in CONDITIONS)
            lines.append(line(audit["repair"], _error(audit, name), *differences))
    return words_grid("repair", ("error of the camera", *CONDITIONS.values()), lines)


def _error(row: Mapping[str, Any], study: str) -> str:
    """Return the error of the camera in words, with the rooms where they are not the usual ones."""
    return f"{FAULTS[row['fault']]}{', blank rooms' * (study == 'blank')}"


def answer(*names: str) -> str:
    """Return whether any audit of these studies has a reversal, and how both pictures compare with
    the live one alone."""
    studies = {name: _read(f"{name}-held-out") for name in names}
    lines = [_reversals([audit for study in studies.values() for audit in study["audits"]])]
    lines[0] += (
        " With the error in both pictures, compared with the live one alone, `plain` succeeds\n"
    )
    for rooms, member in (("marked", lambda name: name != "blank"), ("blank", "blank".__eq__)):
        rows = [row for name in names if member(name) for row in studies[name]["baseline"]]
        clauses = [
            f"{words} ({wording.series(faults)})"
            for sign, words in COMPARED.items()
            if (faults := _of_sign(rows, sign))
        ]
        lines.append(f"- in {rooms} rooms {', '.join(clauses)}.")
    return "\n".join(lines)


def _reversals(audits: Sequence[Mapping[str, Any]]) -> str:
    turned = [audit for audit in audits if "reversal" in audit["turns"].values()]
    lead = f"A reversal is significant in {len(turned)} of" if turned else "No reversal in"
    return f"{lead} {counted(len(audits), 'audit')}."


def _of_sign(rows: Sequence[Mapping[str, Any]], sign: int) -> list[str]:
    """Return the errors whose effect on the baseline, both pictures against one, has this sign."""
    return [FAULTS[row["fault"]] for row in rows if row["effect"][3] == sign]


def stops(library: str) -> str:
    """Return after how many scenes sequential audits stopped, and where each repair is ahead."""
    rows: dict[str, dict[str, Any]] = {}
    for row in _read(f"{library}-stops"):
        rows.setdefault(row["repair"], {})[row["until"]] = row
    lines: list[Line] = []
    for repair, until in rows.items():
        every, first = until["all-decided"], until["decided"]
        counts = (str(row["scenes"]) if row["reached"] else MISSING for row in (first, every))
        shares = (
            every["break_even"][condition] or "not significant" for condition in (ALONE, SHARED)
        )
        lines.append(line(repair, *counts, *shares))
    columns = (
        "scenes until it is significant with both pictures wrong",
        "scenes until it is in all four cases",
        "by how often the live picture alone is wrong",
        "by how often both are",
    )
    return words_grid("repair", columns, lines)


def flown(rooms: str) -> str:
    """Return how much was flown."""
    study = _read(f"{rooms}-held-out")
    seeds = ", ".join(map(str, study["seeds"]))
    return f"{study['scenes']} scenes of `held-out`, trainings {seeds}; bold: significant."


def moves(rooms: str) -> str:
    """Return what errors do to latent states."""
    lines = [
        line(
            move["variant"],
            FAULTS[move["fault"]],
            wording.plain(move["moved"], 2),
            _percent(move["common"]),
            *(wording.plain(move[name], 2) for name in MISSED),
            *(wording.plain(move[name], 2) for name in IMAGINED),
        )
        for move in _read(f"{rooms}-latents")
    ]
    columns = (
        "error of the camera",
        "latent state moves, actions",
        "of that common to all places, %",
        *MISSED.values(),
        *IMAGINED.values(),
    )
    return words_grid("variant", columns, lines)


KIND = {
    "success": success,
    "cancelled": cancelled,
    "effects": effects,
    "flown": flown,
    "stops": stops,
    "moves": moves,
    "answer": answer,
}
"""Functions that fill `latent` blocks; the other words name rooms or studies, or the library."""
