"""Blocks of the page about sensors' faults."""

from collections.abc import Mapping, Sequence
from typing import Any

from blocks import effect_entry, load, words_grid

from faultpath.analyses.model import CORRECT, SHARED
from faultpath.analyses.sentences import wording
from faultpath.analyses.sentences.wording import counted
from faultpath.analyses.tables import line

STUDY = "state-errors"
UNITS = {"position": "m", "velocity": "m/s", "attitude": "deg", "body_rate": "rad/s"}


def audits_of() -> list[dict[str, Any]]:
    """Return the audits: fault, repair, success, effects and comparisons by condition."""
    return load(STUDY).record.model_dump()["audits"]


def title(condition: str) -> str:
    """Return who gets the fault, in words."""
    return {CORRECT: "no fault", SHARED: "at the sensor (shared)"}.get(
        condition, f"at the {condition}"
    )


def conditions(audits: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the conditions of the audits: without a fault, shared, then at one module each."""
    return [CORRECT, SHARED, *audits[0]["turns"]]


def origin() -> str:
    """Return by which code it was flown, in how many scenes."""
    run = load(STUDY)
    return f"{counted(run.record.scenes, 'scene')}, one seed. {run.flown}"


def effects() -> str:
    """Return the effect of every audit under every condition."""
    audits = audits_of()
    lines = [
        line(
            audit["fault"],
            audit["repair"],
            *(effect_entry(audit["effects"][name]) for name in conditions(audits)),
        )
        for audit in audits
    ]
    return words_grid("fault", ("repair", *map(title, conditions(audits))), lines)


def success() -> str:
    """Return the baseline's success in percent, fault by fault and condition by condition."""
    audits = audits_of()
    rates = {audit["fault"]: audit["success"] for audit in audits}
    lines = [
        line(fault, *(wording.plain(100 * rate[name][1], 0) for name in conditions(audits)))
        for fault, rate in rates.items()
    ]
    return words_grid("fault", [*map(title, conditions(audits))], lines)


def reading() -> str:
    """Return what the audits show."""
    return " ".join(sentences(audits_of()))


def sentences(audits: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return in sentences what is significant when shared, what isolated tests show, the rest."""
    signs = {sign: [a for a in audits if a["effects"][SHARED][3] == sign] for sign in (1, -1, 0)}
    shared = [*signs[1], *signs[-1]]
    sentences = [
        f"Of {counted(len(audits), 'audit')} with the fault at the sensor, the "
        f"repair succeeds significantly more often than the baseline in {_named(signs[1])} and "
        f"less often in {_named(signs[-1])}."
    ]
    if shared:
        tests = "; ".join(_isolated(shared, module) for module in shared[0]["turns"])
        sentences.append(f"Of these {counted(len(shared), 'difference')}, {tests}.")
    reversals = sum("reversal" in audit["turns"].values() for audit in audits)
    start = f"A reversal was found in {reversals}"
    if not reversals:
        start = "No reversal was found, which does not show that there is none"
    return [*sentences, f"{start}; inconclusive with the fault at the sensor: {_named(signs[0])}."]


def _named(audits: Sequence[Mapping[str, Any]]) -> str:
    names = [f"{audit['repair']} under {audit['fault']}" for audit in audits]
    return f"{len(audits)} ({wording.series(names)})" if names else "none"


def _isolated(audits: Sequence[Mapping[str, Any]], module: str) -> str:
    """Return in how many audits a test at one module shows what is significant when shared."""
    same = sum(a["effects"][module][3] == a["effects"][SHARED][3] for a in audits)
    differ = sum(a["turns"].get(module, "none") != "none" for a in audits)
    return (
        f"a test {title(module)} alone shows {same or 'none'} "
        f"(significantly different from the shared effect: {differ or 'none'})"
    )


def errors() -> str:
    """Return how large the recorded errors are that are delivered to one module."""
    columns = [f"{name.replace('_', ' ')}, {unit}" for name, unit in UNITS.items()]
    lines = [
        line(row.fault, row.filter, *(wording.plain(row.rms[name], 3) for name in UNITS))
        for row in load(STUDY).record.errors
    ]
    return words_grid("fault", ("filter", *columns), lines)
