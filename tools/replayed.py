"""What the marked blocks of the documents show of sequential audits: stored runs, replayed.

The trials of a run with a fixed number of scenes are looked at in random orders, as a sequential
audit would have flown them. Nothing is flown.
"""

from collections.abc import Mapping
from functools import cache

import numpy as np
from blocks import REFERENCE, Run, load, missing, tabled

from faultpath.planning import LOOK
from faultpath.record.compared import compared
from faultpath.record.family import ALPHA, CORRECT, alpha_shares
from faultpath.selfcheck.sequential import above, against
from faultpath.statistics.inputs import Floats
from faultpath.store import read_outcomes
from faultpath.streams import generator

ORDERS = 1000
RULES = (("decided", None), ("all-decided", 15.0))
"""What audits stop for, and their margins, in percentage points."""


def fill(name: str) -> str:
    """Return a table of the scenes that sequential audits of a stored run would have taken."""
    run = load(name)
    if run is None:
        return missing(name)
    rows = [_row(run, when, margin) for when, margin in RULES]
    columns = {
        "scenes, median": "{median}",
        "95 % of orders": "{low} to {high}",
        "of all trials": "{share:%} %",
        "stopped before the last": "{early:%} %",
        "primary contrast decided, as by all scenes": "{same:%} %",
        "reversal shown by then": "{turned:%} %",
    }
    return tabled("--stop-when", rows, columns, code=True)


def _row(run: Run, when: str, margin_pp: float | None) -> Mapping[str, object]:
    asked, values = run.record.question, _values(run.name)
    most = values[asked.primary].shape[1]
    shares = alpha_shares(list(values), asked.primary)
    wanted = list(values) if when == "all-decided" else [asked.primary]
    settled = np.ones((ORDERS, most), dtype=np.bool_)
    for path in wanted:
        alpha = ALPHA * shares[f"effect/{path}"]
        done = against(values[path], 0.0, 1.0, alpha)
        if margin_pp is not None:
            far = margin_pp / 100.0
            done |= above(values[path], -far, alpha) & above(-values[path], -far, alpha)
        settled &= done
    looks = np.arange(most) % LOOK == LOOK - 1
    settled &= looks
    taken = np.where(settled.any(axis=1), settled.argmax(axis=1) + 1, most)
    at = np.arange(ORDERS), taken - 1
    sides = {
        path: np.sign(each.cumsum(axis=1)[at])
        * against(each, 0.0, 1.0, ALPHA * shares[f"effect/{path}"])[at]
        for path, each in values.items()
    }
    main = next(effect for effect in run.record.effects if effect.path == asked.primary)
    isolated = [sides[path] for path in values if path not in (CORRECT, asked.primary)]
    turned = [sides[asked.primary] * side < 0 for side in isolated]
    low, high = np.quantile(taken, [0.025, 0.975], method="nearest")
    return {
        "name": when + (f" --margin {margin_pp:g}" if margin_pp else ""),
        "median": int(np.median(taken)),
        "low": int(low),
        "high": int(high),
        "share": float(taken.mean() / most),
        "early": float((taken < most).mean()),
        "same": float((sides[asked.primary] == main.sign).mean()),
        "turned": float(np.logical_or.reduce(turned).mean()),
    }


@cache
def _values(name: str) -> Mapping[str, Floats]:
    run = load(name)
    assert run is not None
    question, paths = run.record.question, run.record.paths
    arms, names = (question.repair, question.baseline), [path.name for path in paths]
    table = read_outcomes(REFERENCE / name / "outcomes.parquet")
    found = compared(*arms, names, table, distinct=False)
    orders = np.stack(
        [
            generator("replayed order", question.library_hash, seed).permutation(found.scenes)
            for seed in range(ORDERS)
        ]
    )
    differences = {
        path: (each.arms[0].astype(np.float64) - each.arms[1]).mean(axis=1)
        for path, each in found.trials.items()
    }
    return {path: values[orders] for path, values in differences.items()}
