"""What is to be expected at each share of episodes with the fault, for a reader who moves it."""

import json
from collections.abc import Iterator

from faultpath.record import CORRECT
from faultpath.record.breakeven_words import first, last
from faultpath.record.model import DecisionRecord, Effect, PathBreakEven


def shares(record: DecisionRecord) -> str:
    """Return as JSON, path by path, the success of both arms without and with the fault, and who
    is decided to be ahead from which share of episodes on, in whole percent.

    Empty where the record has no break-even frequency.
    """
    effects = {effect.path: effect for effect in record.effects}
    titles = {path.name: path.title for path in record.paths}
    asked, correct = record.question, effects.get(CORRECT)
    paths = [
        {
            "title": titles.get(each.path, each.path),
            "primary": each.path == asked.primary,
            "baseline": [correct.baseline_percent, faulty.baseline_percent],
            "repair": [correct.repair_percent, faulty.repair_percent],
            "decided": list(_decided(each, correct, faulty)),
        }
        for each in record.break_even
        if correct is not None and (faulty := effects.get(each.path)) is not None
    ]
    if not paths:
        return ""
    return json.dumps({"baseline": asked.baseline, "repair": asked.repair, "paths": paths})


def _decided(path: PathBreakEven, correct: Effect, faulty: Effect) -> Iterator[list[int]]:
    """Yield from which share to which, and for whom: what the sentences of the record say.

    A region counts where it reaches an end at which the family detects an effect on the same
    side. One that reaches the other end too, where nothing is detected, holds for the first alone.
    """
    for region in path.result.regions if path.words else ():
        rare = region.low <= 0.0 and correct.leads and region.sign == correct.sign
        frequent = region.high >= 1.0 and faulty.leads and region.sign == faulty.sign
        low = 0 if rare else 100 if region.low <= 0.0 else first(region.low)
        high = 100 if frequent else 0 if region.high >= 1.0 else last(region.high)
        if (rare or frequent) and low <= high:
            yield [low, high, region.sign]
