"""The platform search: what it may see, how it judges, and that a killed one goes on as it was."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faultpath.quadrotor.platform import FIRST

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def _tools(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))


def test_baselines_alone_are_flown_and_on_the_selection_library_alone():
    import platform_matched as matched

    assert matched.LIBRARY == "selection"
    names = {cell.variant for cell in matched.CELLS.values()}
    names |= {model for cell in matched.CELLS.values() for model, _ in cell.measured}
    assert names == {"dki", "wm-a", "true-parameter", "wm-a-wind/zero-wind"}


def like_the_paper(matched: Any) -> dict[str, list[dict[str, Any]]]:
    """Return flights of every cell that end exactly as the paper's do."""
    blocks: dict[str, list[dict[str, Any]]] = {}
    for cell in matched.CELLS:
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
    found = judging.judged(blocks)
    assert found["distance"] < 0.01  # 78.7 successes of a hundred are 79
    assert set(found["groups"]) == {"accuracy", "outcomes", "times", "calibration", "wind"}
    assert len(found["quantities"]) == len(matched.QUANTITIES)
    blocks["WM-A, e = +0.1"][0]["status"] = ["crash"] * 100
    blocks["DKI"][0]["time_s"] = [5.0] * 100
    worse = judging.judged(blocks)
    assert worse["distance"] > found["distance"]
    assert worse["quantities"]["success, WM-A, e = +0.1"]["departure"] < -1
    assert worse["quantities"]["time, DKI"]["departure"] == pytest.approx(
        np.log(5.0 / 4.25) / judging.TOLERANCE, abs=0.01
    )


def test_what_cannot_be_told_departs_by_the_cap_and_what_was_not_flown_is_left_out():
    import platform_judged as judging
    import platform_matched as matched

    blocks = like_the_paper(matched)
    blocks["DKI"][0]["status"] = ["timeout"] * 100
    windless = {name: found for name, found in blocks.items() if "zero wind" not in name}
    found = judging.judged(windless)
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


def test_a_search_that_was_killed_goes_on_as_if_it_had_not_been(tmp_path, monkeypatch):
    import platform_search as search

    left = 4

    def measure(found: Any, platform: Any, scenes: int, seeds: Any) -> dict[str, Any]:
        nonlocal left
        if left == 0:
            raise KeyboardInterrupt
        left -= 1
        number = sum(platform.hash.encode())
        return {"distance": float(number % 97 + scenes), "groups": {}, "quantities": {}}

    def record(folder: Path) -> dict[str, Any]:
        found = json.loads((folder / "search.json").read_text())
        for trial in found["trials"]:
            trial.pop("seconds")
        return found

    monkeypatch.setattr(search.Search, "measure", measure)
    with pytest.raises(KeyboardInterrupt):
        search.search(search.Search(tmp_path / "killed"), 3)
    left = 100
    search.search(search.Search(tmp_path / "killed"), 3)
    search.search(search.Search(tmp_path / "whole"), 3)
    assert record(tmp_path / "killed") == record(tmp_path / "whole")
    states = [trial["state"] for trial in record(tmp_path / "whole")["trials"]]
    assert states[0] == "complete"
    assert set(states) <= {"complete", "pruned"}
    monkeypatch.setattr(search, "code_of", lambda *modules: "other")
    with pytest.raises(SystemExit, match="with other code than this"):
        search.Search(tmp_path / "whole")
