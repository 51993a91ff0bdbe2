"""The platform is frozen: the code still says what the search chose."""

import json
from pathlib import Path

from faultpath.quadrotor.platform import platform, platform_hash

FROZEN = Path(__file__).parents[2] / "docs/design/platform-search/frozen.json"


def test_the_code_is_the_frozen_platform():
    frozen = json.loads(FROZEN.read_text())
    assert json.loads(json.dumps(platform())) == frozen["platform"]
    assert platform_hash() == frozen["hash"]


def test_both_frozen_records_stay():
    first = json.loads((FROZEN.parent / "frozen-analytic.json").read_text())
    assert first["hash"] != json.loads(FROZEN.read_text())["hash"]
    assert first["platform"]["wind"] == json.loads(FROZEN.read_text())["platform"]["wind"]


def test_the_chosen_record_flew_the_frozen_planner():
    """The last stage of the search flew, among others, exactly what is frozen."""
    planner = platform()["planner"]
    flown = [
        result
        for result in json.loads((FROZEN.parent / "6-learned-chosen.json").read_text())
        if result["planner"] == "terminal"
    ]
    assert flown
    for result in flown:
        point = result["point"]
        assert planner["temperature"] == point["temperature"]
        assert planner["sampler"]["rate_sigma_radps"][0] == point["rate_sigma"]
        for weight in ("rate_effort", "margin_m", "thrust_effort"):
            assert planner["terminal"][weight] == point[weight]
