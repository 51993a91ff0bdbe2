"""Results with trials missing, laid out and decided as `faultpath judge` does."""

from contextlib import ExitStack
from itertools import product
from typing import Any
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from faultpath.analyses.decide import decide
from faultpath.analyses.judging import pair_results
from faultpath.analyses.model import AuditResult
from faultpath.core.errors import UserError
from faultpath.core.streams import generator
from faultpath.run.received.question import JudgeQuestion
from faultpath.run.received.results import Received
from faultpath.stats.estimate import BreakEven
from faultpath.system.outcome import Status

Bools = NDArray[np.bool_]
BLANKS = (
    *product(("one-sided", "opposite"), (1, 3)),
    ("repeated", 3),
    *product(("clustered", "both"), (1, 3)),
)
"""Kinds of missing trials, with the number of seeds."""
CONDITIONS = ("nominal", "isolated:observer", "shared")
SHIFTS = (-0.1, 0.05, 0.15)
"""Changes of the repair's success by condition, where it differs: even at a share of .4, and of .67
and more."""
SCENES = 60
_NOT_ASKED = BreakEven(
    p_star=None,
    pieces=((0.0, 1.0),),
    kind="whole",
    regions=(),
    level=0.95,
    method="not asked",
    estimand="",
)


def judged(
    success: Bools, blank: Bools, cluster: str = "scene", shares: bool = True
) -> AuditResult:
    """Return the record of `success` [variants, conditions, scenes, seeds] without what is `blank`.

    Break-even sets are left out unless `shares` asks for them.
    """
    rows: list[Received] = []
    for at in product(*map(range, success.shape)):
        if blank[at]:
            continue
        variant, condition, scene, seed = at
        status = Status.SUCCESS if success[at] else Status.CRASH
        named = (
            (f"task {scene}", f"{seed}", "") if cluster == "task" else ("", f"{scene}", f"{seed}")
        )
        where = ("old", "new")[variant], CONDITIONS[condition], *named
        rows.append(Received("line", *where, status, "", float("nan")))
    asked = JudgeQuestion.model_validate({"baseline": "old", "repair": "new", "cluster": cluster})
    laid = pair_results(rows, asked)
    # What decides nothing here takes most of the time: what could have been detected, and curves.
    unread: dict[str, Any] = {"decide.detectable": None, "shares.mixture_curve": ()}
    if not shares:
        unread["shares.break_even"] = _NOT_ASKED
    with ExitStack() as stack:
        for name, value in unread.items():
            stack.enter_context(patch(f"faultpath.analyses.{name}", return_value=value))
        return decide(laid.question, laid.facts, laid.conditions, laid.trials, laid.findings)


def drawn(
    stream: np.random.Generator, kind: str, seeds: int, shifts: tuple[float, ...]
) -> tuple[Bools, Bools]:
    """Return success and what is missing of it [variants, conditions, scenes, seeds]."""
    tasks = 5 if kind == "clustered" else 1
    shape = (2, 3, SCENES, seeds * tasks)
    own = stream.random(shape) + 0.8 * (stream.random((1, 1, SCENES, 1)) - 0.5)
    success = own < 0.5 + np.array([np.zeros(3), shifts])[:, :, np.newaxis, np.newaxis]
    if kind == "repeated":
        success[:] = success[..., :1]
    bad = np.stack([success[0] if kind == "opposite" else success[0] & False, ~success[1]])
    rate = 0.03 if kind == "clustered" else 0.2
    blank = bad & (stream.random(shape) < rate)
    if kind == "repeated":
        blank[..., 1:] = False
    if kind == "both":  # both die, most often where only the baseline would succeed
        dies = np.where(success[0] & ~success[1], 0.6, 0.05)
        blank[:] = stream.random(shape[1:]) < dies
    if kind == "clustered":  # half of the tasks have a scene less, in both variants
        blank[:, :, ::2, -1] = True
    return success, blank


def wrong(record: AuditResult, shifts: tuple[float, ...]) -> bool:
    """Return whether any break-even set puts a variant ahead where the other one is."""
    ends = dict(zip(("correct", "observer", "shared"), shifts, strict=True))
    sets = [(each, "correct", each.condition) for each in record.break_even]
    sets += [(each, each.condition, "shared") for each in record.break_even_beta]
    for each, none, every in sets:
        for region in each.result.regions:
            for share in (region.low + 1e-9, region.high - 1e-9):
                ahead = (1.0 - share) * ends[none] + share * ends[every]
                if ahead * region.sign < 0.0:
                    return True
    return False


def blanks(kind: str, seeds: int, runs: int = 100) -> tuple[float, float]:
    """Return the share of results of equal variants that announce anything, and of those of
    variants that differ in which any break-even set is wrong."""
    stream = generator("statistics", f"blanks {kind} {seeds}", 0)
    rates = [0, 0]
    for column, shifts in enumerate(((0.0, 0.0, 0.0), SHIFTS)):
        for _ in range(runs):
            try:
                record = judged(
                    *drawn(stream, kind, seeds, shifts),
                    "task" if kind == "clustered" else "scene",
                    shares=bool(column),
                )
            except UserError:  # nothing is left, and nothing is said
                continue
            announced = any(each.sign for each in (*record.effects, *record.changes))
            rates[column] += wrong(record, shifts) if column else announced
    return rates[0] / runs, rates[1] / runs
