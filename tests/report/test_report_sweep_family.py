"""A sweep over sizes announces seldom what is not there, however many sizes it has."""

from dataclasses import replace

import numpy as np
import pytest
from page_reader import with_record

from faultpath.analyses.family import contrasts_of
from faultpath.analyses.model import CORRECT
from faultpath.report.compared import Compared, together
from faultpath.report.inputs import ReportInput


def drawn(source: ReportInput, rng: np.random.Generator, sizes: int) -> list[Compared]:
    """Return sizes of which no variant differs, each detected by itself where its p is low
    enough."""
    runs: list[Compared] = []
    correct = float(rng.random())
    for number in range(1, sizes + 1):
        told = []
        for effect in source.record.effects:
            p = correct if effect.condition == CORRECT else float(rng.random())
            own = min(1.0, len(contrasts_of(source.record)) * p)
            sign = (1 if rng.random() < 0.5 else -1) if own <= 0.05 else 0
            changed = {"p_value": p, "corrected_p": own, "sign": sign}
            told.append(effect.model_copy(update=changed))
        question = source.record.question.model_copy(update={"fault": f"calibration={number}"})
        sized = with_record(source, effects=tuple(told), question=question)
        runs.append(Compared(number, f"runs/{number}", sized))
    return runs


@pytest.mark.parametrize("sizes", [2, 9])
def test_the_family_is_that_of_all_sizes(one_seed: ReportInput, sizes: int) -> None:
    rng, sweeps, alone, family = np.random.default_rng(sizes), 150, 0, 0
    for _ in range(sweeps):
        runs = together(drawn(one_seed, rng, sizes))
        alone += any(effect.sign for run in runs for effect in run.record.effects)
        family += any(sign for run in runs for sign, _ in (run.family or {}).values())
    assert family <= (0.05 + 3 * np.sqrt(0.05 * 0.95 / sweeps)) * sweeps
    assert sizes < 9 or alone > 0.08 * sweeps


def test_correct_inputs_that_are_the_same_trials_count_once(one_seed: ReportInput) -> None:
    runs = drawn(one_seed, np.random.default_rng(0), 3)
    weights = {name: weight for name, (_, weight) in contrasts_of(runs[0].record).items()}
    once = weights["effect/correct"]
    lowest = 1e-30

    def low(run: Compared) -> Compared:
        told = tuple(
            each.model_copy(update={"p_value": lowest} if each.condition == CORRECT else {})
            for each in run.record.effects
        )
        return replace(run, source=with_record(run.source, effects=told))

    first = together([low(run) for run in runs])[0].family
    assert first is not None
    assert first[CORRECT][1] == pytest.approx(
        (3 * sum(weights.values()) / once - 2) * lowest, abs=0
    )
