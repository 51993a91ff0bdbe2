"""The platform search: what it may see, how it judges, and that a killed one goes on as it was."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faultpath.quadrotor.platforms import FIRST, MATCHED
from faultpath.work import Here

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def _tools(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))


def test_baselines_alone_are_flown_and_on_the_selection_library_alone():
    import platform_matched as matched

    assert matched.LIBRARY == "selection"
    names = {cell.variant for cell in matched.CELLS.values()}
    names |= {quantity.model[0] for quantity in matched.QUANTITIES} - {""}
    zero = {"wm-a-wind/zero-wind", "true-parameter/zero-wind"}
    assert names == {"dki", "wm-a", "true-parameter"} | zero


def test_what_is_not_fitted_has_the_true_parameters_standing_in_for_what_faults_cost():
    import platform_matched as matched

    assert matched.quantities({"wm-a", "wm-a-wind"}) == matched.QUANTITIES
    lowest = matched.quantities(())
    assert {each.cell for each in lowest} == {
        "DKI",
        "true-parameter",
        "true-parameter, true clearance",
        *matched.STAND_INS,
    }
    assert {model for each in lowest for model in [each.model] if model[0]} == {
        ("dki", 0.0),
        ("true-parameter", 0.0),
        ("true-parameter", 0.1),
        ("true-parameter", -0.1),
    }
    targets = {each.name: each.target for each in matched.QUANTITIES}
    assert all(each.target == targets[each.name] for each in lowest)
    middle = {each.cell for each in matched.quantities({"wm-a"})}
    assert "WM-A, e = +0.1" in middle
    assert "true-parameter for zero wind, L3" in middle


def like_the_paper(matched: Any) -> dict[str, list[dict[str, Any]]]:
    """Return flights of every cell that end exactly as the paper's do."""
    blocks: dict[str, list[dict[str, Any]]] = {}
    for cell in matched.PAPER_CELLS:
        asked = [quantity for quantity in matched.QUANTITIES if quantity.cell == cell]
        share = {q.kind: round(100 * q.target) for q in asked if q.kind != "error"}
        successes, crashes = share.get("success", 0), share.get("crash", 0)
        status = ["success"] * successes + ["crash"] * crashes
        time = next((q.target for q in asked if q.kind == "time"), 1.0)
        blocks[cell] = [
            {
                "status": status + ["timeout"] * (100 - len(status)),
                "time_s": [time] * 100,
                "errors": [
                    {
                        "model": q.model[0],
                        "error": q.model[1],
                        "scenes": list(range(100)),
                        "missed_m": [q.target] * 100,
                    }
                    for q in asked
                    if q.kind == "error"
                ],
            }
        ]
    return blocks


def test_a_platform_like_the_paper_s_is_at_no_distance_and_departures_have_a_sign():
    import platform_judged as judging
    import platform_matched as matched

    blocks = like_the_paper(matched)
    found = judging.judged(matched.QUANTITIES, blocks)
    assert found["distance"] < 0.01  # 78.7 successes of a hundred are 79
    assert set(found["groups"]) == {"accuracy", "outcomes", "times", "calibration", "wind"}
    assert len(found["quantities"]) == len(matched.QUANTITIES)
    blocks["WM-A, e = +0.1"][0]["status"] = ["crash"] * 100
    blocks["DKI"][0]["time_s"] = [5.0] * 100
    worse = judging.judged(matched.QUANTITIES, blocks)
    assert worse["distance"] > found["distance"]
    assert worse["quantities"]["success, WM-A, e = +0.1"]["departure"] < -1
    assert worse["quantities"]["time, DKI"]["departure"] == pytest.approx(
        np.log(5.0 / 4.25) / judging.TOLERANCE, abs=0.01
    )


def test_what_cannot_be_told_departs_by_the_cap_and_only_what_is_asked_counts():
    import platform_judged as judging
    import platform_matched as matched

    blocks = like_the_paper(matched)
    blocks["DKI"][0]["status"] = ["timeout"] * 100
    windless = [quantity for quantity in matched.QUANTITIES if quantity.group != "wind"]
    found = judging.judged(windless, blocks)
    assert found["quantities"]["time, DKI"] == {
        "value": None,
        "standard_error": None,
        "departure": judging.CAP,
    }
    assert set(found["groups"]) == {"accuracy", "outcomes", "times", "calibration"}


def test_a_point_keeps_the_winds_accelerations_and_the_collection_has_both_ends():
    import platform_space as space

    for point in space.STARTS:
        platform = space.platform_of(point)
        means = np.array(platform.winds.means_mps)
        assert means[3] * platform.drag_kgps[0] == pytest.approx(point["wind_mps2"], abs=1e-3)
        ratios = np.array(FIRST.winds.means_mps) / FIRST.winds.means_mps[3]
        assert means / means[3] == pytest.approx(ratios, abs=1e-3)
        assert platform.winds.pool_mean_mps[1] * platform.drag_kgps[0] == pytest.approx(3.0)
        assert platform.follows_motors
    assert set(space.STARTS[0]) == set(space.SPACE)
    assert space.collection_of(1.0) == FIRST.collection
    gentle = space.collection_of(0.0)
    assert gentle.perturbation.thrust_sigma == 0.08
    assert gentle.controller.speed_mps == (1.0, 3.4)


def test_the_frozen_platform_is_the_best_finalist():
    import platform_space as space

    record = json.loads((ROOT / "docs/design/platform-search/7-matched.json").read_text())
    finalists = [trial for trial in record["trials"] if "final" in trial]
    assert len(finalists) > 1
    best = min(finalists, key=lambda trial: trial["final"]["distance"])
    assert space.platform_of(best["point"]) == MATCHED


def test_a_search_that_was_killed_goes_on_as_if_it_had_not_been(tmp_path, monkeypatch):
    import platform_measured as measured
    import platform_search as search

    left = 6

    def measure(found: Any, platform: Any, rung: int, seeds: Any) -> dict[str, Any]:
        nonlocal left
        if left == 0:
            raise RuntimeError("killed")
        left -= 1
        number = sum(platform.hash.encode())
        return {"distance": float(number % 97 + rung), "groups": {}, "quantities": {}}

    def searched(name: str) -> dict[str, Any]:
        search.search(search.Search(tmp_path / name, Here()), 5)
        return json.loads((tmp_path / name / "search.json").read_text())

    monkeypatch.setattr(search, "GENERATION", 3)
    monkeypatch.setattr(search, "STARTS", (*search.STARTS, *search.STARTS))
    monkeypatch.setattr(measured.Measurer, "measure", measure)
    with pytest.raises(RuntimeError):
        searched("killed")
    left = 100
    assert searched("killed") == searched("whole")
    trials = searched("whole")["trials"]
    assert len(trials) == 5
    assert {trial["state"] for trial in trials} == {"complete", "pruned"}
    for trial in trials:
        assert len(trial["rungs"]) == 3 or trial["state"] == "pruned"
    monkeypatch.setattr(search, "code_of", lambda *modules: "other")
    with pytest.raises(SystemExit, match="with other code than this"):
        search.Search(tmp_path / "whole", Here())
