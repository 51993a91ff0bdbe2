"""The page on drifting and partly shared errors: what was flown, and that its words are decided."""

from pathlib import Path

import numpy as np
import pytest

from faultpath.faults import Draws, Fault, Moment
from faultpath.record import CORRECT, SHARED
from faultpath.store import read_outcomes

ROOT = Path(__file__).resolve().parents[2]
SCENES = tuple(f"scene-{i}" for i in range(1500))
DT_S = 0.5


@pytest.fixture
def decided(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    import drift_decided

    return drift_decided


def errors(faults: tuple[Fault, ...], module: str, channel: str, steps: int) -> np.ndarray:
    """Return the relative error of a reading, `[steps, scenes]`."""
    readings = np.ones((steps, len(SCENES)))
    for fault in faults:
        if fault.consumers != (module,) or fault.channel != channel:
            continue
        draws: Draws = fault.draws(SCENES, 0)
        memory = fault.intervention.begin(readings[0], Moment(0, 0, DT_S, draws))
        for step in range(steps):
            at = Moment(step, step, DT_S, draws)
            readings[step], memory = fault.intervention.apply(readings[step], memory, at)
    return readings - 1


@pytest.mark.parametrize("path", ["correlation 0", "correlation 0.5", SHARED])
def test_the_errors_that_flew_have_the_size_and_the_correlation_of_the_design(
    decided, path: str
) -> None:
    faults = decided.study.design().faults("drift", path)
    at = {
        (module, channel): errors(faults, module, channel, 6)
        for module in ("reconstruction", "predictor")
        for channel in ("mass", "thrust_scale")
    }
    first, second = at["reconstruction", "mass"], at["predictor", "mass"]
    expected = 1.0 if path == SHARED else float(path.split()[1])
    for step in (0, 5):
        assert np.corrcoef(first[step], second[step])[0, 1] == pytest.approx(expected, abs=0.06)
        for each in (first, second):
            assert each[step].std() == pytest.approx(0.1, rel=0.06)
    for each in (first, second):  # five steps of half a second are the time constant
        assert np.corrcoef(each[0], each[5])[0, 1] == pytest.approx(np.exp(-1), abs=0.06)
    np.testing.assert_allclose(at["reconstruction", "thrust_scale"], -first, atol=1e-12)
    # Two shares of an error are multiplied: opposite but for their product.
    np.testing.assert_allclose(at["predictor", "thrust_scale"], -second, atol=0.1)
    assert (at["predictor", "thrust_scale"] + second).std() < 0.01


def test_correct_inputs_flew_as_in_the_main_job(decided) -> None:
    def flown(folder: str) -> dict[tuple[str, str], tuple[object, ...]]:
        rows = read_outcomes(ROOT / "docs" / "reference" / folder / "outcomes.parquet").rows
        return {
            (row.variant, row.outcome.scene): (row.outcome.status, row.outcome.time_s)
            for row in rows
            if row.path == CORRECT
        }

    assert flown("drift-L3") == flown(decided.study.design().like)


def test_what_the_page_says_in_words_of_its_own_is_decided(decided) -> None:
    """Its numbers are filled in; a change of these decisions asks for other sentences."""
    fixed, drift = (decided.laws()[law].family for law in ("fixed", "drift"))
    assert {path for path, each in fixed.effects.items() if each.sign} == {"reconstruction"}
    assert fixed.effects["reconstruction"].sign == 1
    assert fixed.changes["reconstruction"].sign == -1
    assert not any(each.sign for each in drift.effects.values())
    assert drift.changes["correlation 0"].sign == -1
    assert not any(turn == "reversal" for law in (fixed, drift) for turn in law.turns.values())
    assert decided.constant().record.changes[-1].turn != "reversal"
