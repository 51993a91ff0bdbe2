"""What the page says of the reconstructed wind along a flight follows from what was measured."""

import json
import re
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
MEASURED = ROOT / "docs" / "reference" / "wind-error.json"


@pytest.fixture
def wind_error(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    import wind_error

    return wind_error


def numbers(text: str) -> list[float]:
    return [float(each) for each in re.findall(r"-?[\d.]+", text.replace("−", "-"))]


def measured() -> dict[tuple[str, str], dict[str, list[float]]]:
    """Return what stands in the table, by reconstruction, step and column."""
    table = json.loads(MEASURED.read_text("utf-8"))["table"]
    found: dict[tuple[str, str], dict[str, list[float]]] = {}
    of = ""
    for line in table["lines"]:
        of = of if line.get("entries") else line["label"]
        texts = [numbers(entry["text"]) for entry in line.get("entries", ())]
        found[of, line["label"]] = dict(zip(table["columns"], texts, strict=False))
    return found


def test_the_prose_holds() -> None:
    found = measured()
    along, held, error = (
        "Along the motion (m/s)",
        "Held minus updated (m/s)",
        "Error then (m/s)",
    )
    gentle = found["Trajectory GRU", "Step 20"]
    braking = found["Trajectory GRU", "Step 40"]
    assert gentle[held][2] < 0, "held from the paper's step it is nearer to the wind"
    assert gentle[along][1] < 0 < gentle[along][2], "no error along the motion is seen there"
    assert gentle["Speed (m/s)"][0] > braking["Speed (m/s)"][0]
    assert braking[along][1] > 1, "it points along the motion while the vehicle brakes"
    assert max(map(abs, braking[held])) < 0.2, "held, it errs about as far as the updated one"
    assert max(map(abs, found["GRU", "Step 40"][along])) < 0.5, "the other hardly does"
    steps = [row for (of, _), row in found.items() if of == "Trajectory GRU" and row]
    assert min(row[error][0] for row in steps) == gentle[error][0]


def test_errors_are_those_of_the_estimate_of_each_step(wind_error: ModuleType) -> None:
    wind = np.tile([3.0, 0.0, 0.0], (4, 1))
    estimate = np.array([[0.0, 0, 0], [3, 0, 4], [3, 0, 0], [4, 0, 0]])
    velocity = np.array([[0.0, 0, 0], [0, 0, -2], [0, 1, 0], [2, 0, 0]])
    flight = wind_error.Flight(estimate, wind, velocity)
    assert [flight.flying(step) for step in (0, 3, 4)] == [True, True, False]
    assert np.linalg.norm(flight.error(1)) == 4
    assert np.isnan(flight.along(0))
    assert [flight.along(step) for step in (1, 2, 3)] == [-4, 0, 1]
    assert flight.left(estimate[1], 1) == 4
    assert flight.left(estimate[1:], 1) == pytest.approx((4 + 0 + 1) / 3)


def test_a_flight_that_ended_counts_no_more(wind_error: ModuleType) -> None:
    still = np.zeros((2, 3))
    longer = wind_error.Flight(np.ones((5, 3)), np.zeros((5, 3)), np.ones((5, 3)))
    resamples = wind_error.Resamples.draw("test", 2, n_resamples=100)
    line = wind_error._line([wind_error.Flight(still, still, still), longer], 3, resamples)
    assert [entry.text for entry in line.entries[:3]] == ["1", "1.73", "1.73"]
