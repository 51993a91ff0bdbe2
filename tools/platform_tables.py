"""The tables of the search for matched baselines, from its record."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from blocks import tabled

from faultpath.record import wording

Record = Mapping[str, Any]
SHOWN = 10


def space(record: Record) -> str:
    """Return what was searched."""

    def rows() -> Iterator[dict[str, str]]:
        for name, given in record["space"].items():
            if "choices" in given:
                values = " or ".join(str(each) for each in given["choices"])
            else:
                steps = "logarithmic" if given.get("log") else f"in steps of {given['step']:g}"
                values = f"{given['low']:g} to {given['high']:g}, {steps}"
            yield {"name": name, "values": values}

    return tabled("parameter", rows(), {"values": "{values}"}, code=True, words="values")


def quantities(record: Record) -> str:
    """Return what is matched: targets, and the best trials beside them, with departures."""
    best = _best(record)[:3]
    shown = {f"trial {trial['number']}": _highest(trial) for trial in best}
    if "first" in record:
        shown = {"first": record["first"]} | shown
    rows = []
    for each in record["matched"]:
        row = {
            "name": each["name"],
            "group": each["group"],
            "the paper": _said(each, each["target"]),
        }
        for name, found in shown.items():
            row[name] = _found(each, found["quantities"].get(each["name"]))
        rows.append(row)
    columns = {key: f"{{{key}}}" for key in ("group", "the paper", *shown)}
    scenes = {trial["rungs"][-1]["scenes"] for trial in best}
    note = (
        f"\n\nOn {' or '.join(map(str, sorted(scenes)))} selection scenes, seed 0; after a final "
        "also seeds 1 and 2 where the paper averages. Plus-minus: one standard error; in brackets "
        "the departure, of which the distance is made."
        if scenes
        else ""
    )
    return tabled("quantity", rows, columns) + note


def trials(record: Record) -> str:
    """Return the best trials, those that got furthest first."""
    made = record["trials"]
    best = _best(record)[:SHOWN]
    if not best:
        return "*No trial has been flown yet.*"
    names = list(record["space"])
    rows = [
        {
            "name": f"trial {trial['number']}" + (", by hand" if "by_hand" in trial else ""),
            "scenes": str(trial["rungs"][-1]["scenes"]),
            "distance": wording.plain(trial["rungs"][-1]["distance"], 2),
            **{name: _value(trial["point"][name]) for name in names},
        }
        for trial in best
    ]
    columns = {key: f"{{{key}}}" for key in ("scenes", "distance", *names)}
    ended = {state: sum(trial["state"] == state for trial in made) for state in _STATES}
    counts = ", ".join(f"{count} {state}" for state, count in ended.items() if count)
    return (
        f"{tabled('', rows, columns)}\n\nThe best of {len(made)} trials ({counts}), with code of "
        f"commit `{record['commit']}`."
    )


PARTS: Mapping[str, Callable[[Record], str]] = {
    "space": space,
    "quantities": quantities,
    "trials": trials,
}
_STATES = ("complete", "pruned", "running")


def _best(record: Record) -> list[dict[str, Any]]:
    measured = [trial for trial in record["trials"] if trial["rungs"]]

    def rank(trial: dict[str, Any]) -> tuple[int, float]:
        return -trial["rungs"][-1]["scenes"], trial["rungs"][-1]["distance"]

    return sorted(measured, key=rank)


def _highest(trial: dict[str, Any]) -> dict[str, Any]:
    return trial.get("final") or trial["rungs"][-1]


def _said(asked: Mapping[str, Any], value: float | None) -> str:
    if value is None:
        return "none"
    if asked["kind"] == "time":
        return f"{wording.plain(value, 2)} s"
    unit = "cm" if asked["kind"] == "error" else "%"
    return f"{wording.plain(100 * value, 1)} {unit}"


def _found(asked: Mapping[str, Any], row: Mapping[str, Any] | None) -> str:
    if row is None:
        return ""
    if row["value"] is None:
        return f"none ({wording.signed(row['departure'], 1)})"
    value = _said(asked, row["value"]).partition(" ")[0]
    error = _said(asked, row["standard_error"]).partition(" ")[0]
    return f"{value} ± {error} ({wording.signed(row['departure'], 1)})"


def _value(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)
