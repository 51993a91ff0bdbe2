"""What a search tries and chooses, the mistakes in asking for one, and that it says only what its
confirming audit decided."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from outcome_tables import MOST_WORDS, SCENES, question, three
from outcome_tables import record as audit

from faultpath.core.errors import UserError
from faultpath.decisions.fault_groups import fault_of
from faultpath.decisions.search.bounds import BoundedFault, Bounds
from faultpath.decisions.search.decide import conclude
from faultpath.decisions.search.model import ResolvedSearch, SearchRecord, Tried
from faultpath.decisions.search.propose import proposals
from faultpath.decisions.search.study import SearchPlan, halves, plan_search, regret
from faultpath.trials import SystemSpec, library_of, load_system
from faultpath.trials.question import SearchQuestion, ask

SPEC = SystemSpec(name=f"{Path(__file__).resolve().parents[2] / 'examples' / 'toy.py'}:create")
TOY = load_system(SPEC)
LIBRARY = library_of(TOY, "carts")
GAIN = "isolated: observer\nfaults:\n- {fault: gain, size: [0.6, 1.4]}\n"


def plan(tmp_path: Path, bounds: str, **given: Any) -> SearchPlan:
    (tmp_path / "bounds.yaml").write_text(bounds)
    asked = {"baseline": "calibrated", "repair": "blind", "within": tmp_path / "bounds.yaml"}
    return plan_search(TOY, SPEC, ask(SearchQuestion, asked | given), LIBRARY)


@pytest.mark.parametrize(
    ("bounds", "said"),
    [
        ("isolated: observer\nfaults: []\n", "faults: is .*at least 1"),
        (GAIN.replace("size", "sizes"), "line 3: .*sizes: is no field; did you mean 'size'"),
        (GAIN.replace("[0.6, 1.4]", "[1.4, 0.6]"), "line 3: .*give the lower end first"),
        (GAIN.replace("[0.6, 1.4]", "[-1e308, 1e308]"), "line 3: .*reaches -1e.308: give ends"),
        (GAIN.replace("[0.6, 1.4]", "[1, 1]"), "nothing is left to search"),
        (GAIN.replace(", size: [0.6, 1.4]", ""), "declares no uncertainty"),
        (GAIN.replace("gain", "'gain:scale=0.6'"), "the search sets size and place"),
        (GAIN.replace("gain", "'gain:freeze'"), "freeze has no size"),
        (GAIN.replace("gain", "'gain:scale,onset=3'") + "onset: [0, 9]", "'onset' has a range"),
        (GAIN.replace("observer", "pilot"), "'pilot' is no module .* controller, observer"),
        (GAIN.replace("gain", "target"), "only the controller gets this fault"),
        (GAIN + "correlation: [0, 1]\n", "correlation is of errors that are drawn"),
    ],
)
def test_a_mistake_in_the_bounds_is_one_sentence(bounds: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=said) as raised:
        plan(tmp_path, bounds)
    assert str(raised.value).startswith(str(tmp_path / "bounds.yaml"))
    assert "\n" not in str(raised.value)


def test_faults_stay_within_the_bounds_and_can_be_typed() -> None:
    bounds = Bounds(
        isolated="observer",
        faults=(
            BoundedFault(fault="gain:bias,relative", size=(0.0, 0.3)),
            BoundedFault(fault="velocity:bias", size=(0.0, 2.0)),
            BoundedFault(fault="position:delay", size=(0.0, 4.0)),
        ),
        onset=(5, 10),
        correlation=(-1.0, 1.0),
    )
    assert bounds.fault([0.0, 1.0, 0.3, 0.5, 0.18]) == (
        "gain:bias=0,relative,onset=8,loading=0.8 & velocity:bias=2,onset=8,loading=-0.8 & "
        "position:delay=1,onset=8"
    )
    for point in np.random.default_rng(0).random((20, 5)):
        gain, velocity, position = fault_of(TOY, bounds.fault(point.tolist())).faults
        assert gain.loading * velocity.loading == pytest.approx(2 * point[4] - 1, abs=6e-3)
        assert 0 <= gain.intervention.std <= 0.3
        assert 5 <= position.onset_step <= 10


def test_joined_faults_have_one_cause_at_every_size_and_share_what_their_loadings_say() -> None:
    text = "gain:bias={},loading=0.6 & velocity:bias=0.1,relative,loading=-0.6"
    parts = [p for size in (1, 2) for p in fault_of(TOY, text.format(size)).resolved(TOY.interface)]
    assert {part.cause for part in parts} == {"gain:bias & velocity:bias"}
    assert [(part.channel, part.loading) for part in parts[:2]] == [
        ("gain", 0.6),
        ("velocity", -0.6),
    ]
    for wrong, said in (
        ("gain:scale=1.1,loading=0.5 & velocity:noise=1", "and of errors that are drawn"),
        ("gain:noise=1 & velocity:noise=1,loading=2", "a number from -1 to 1"),
        ("gain:noise=1 & ", "empty"),
        ("gain:noise=1@observer & velocity:scale=2", "leave '@' out"),
    ):
        with pytest.raises(UserError, match=said):
            fault_of(TOY, wrong)


def test_no_scene_changes_its_half_with_the_number_of_scenes(tmp_path: Path) -> None:
    every, few = halves(LIBRARY, None), halves(LIBRARY, 31)
    assert {*every[0], *every[1]} == {scene.id for scene in LIBRARY.scenes}
    assert len(every[0]) == len(every[1]) == 50
    assert set(few[0]) < set(every[0])
    assert set(few[1]) < set(every[1])
    made = plan(tmp_path, GAIN, scenes=31)
    assert not {*made.study(["gain:scale=0.7"]).scenes} & {
        *made.audit("gain:scale=0.7").study.scenes
    }
    with pytest.raises(UserError, match="give 2 --scenes"):
        halves(LIBRARY, 1)


def proposed(seed: int) -> list[np.ndarray]:
    source, seen = proposals(2, seed, 60), []
    points = next(source)
    while points:
        seen += points
        try:
            points = source.send([-float(((p - [0.8, 0.3]) ** 2).sum()) for p in points])
        except StopIteration:
            break
    return seen


def test_proposals_follow_from_seed_and_values_and_find_a_peak() -> None:
    one, other = proposed(0), proposed(1)
    np.testing.assert_array_equal(one, proposed(0))
    assert len(one) == len(other) == 60
    assert not np.array_equal(one, other)
    assert np.min(one) >= 0
    assert np.max(one) <= 1
    assert np.abs(np.array(one[-6:]) - [0.8, 0.3]).max() < 0.15


def test_regret_is_what_the_isolated_choice_loses() -> None:
    lead, behind = np.repeat([1.0, 0.0], [8, 12]), np.repeat([-1.0, 0.0], [12, 8])
    assert regret(lead, behind) == pytest.approx(0.6)
    assert regret(-lead, -behind) == pytest.approx(0.6), "whoever leads"
    assert regret(lead, -behind) == pytest.approx(-0.6), "the choice was right"
    slight = np.repeat([1.0, 0.0], [2, 18])
    assert regret(slight, behind) == pytest.approx(0.1), "no audit would choose by that"
    assert regret(np.zeros(20), behind) == 0


def record(*counts: Any, regret_pp: float = 40.0) -> SearchRecord:
    confirmed = three(*counts) if counts else None
    fault = confirmed.question.fault if confirmed else "gain:scale=0.7"
    bounds = Bounds(isolated="observer", faults=(BoundedFault(fault="gain", size=(0.6, 1.4)),))
    same = question().model_dump(include={*ResolvedSearch.model_fields})
    more = {"candidates": 8, "search_seed": 3, "finding": SCENES, "confirming": SCENES}
    resolved = ResolvedSearch.model_validate(same | more | {"bounds": bounds})
    shown = {"isolated_pp": 40.0, "shared_pp": -regret_pp, "regret_pp": regret_pp}
    return conclude(resolved, [Tried(fault=fault, **shown)], confirmed)


def test_a_reversal_is_announced_where_the_audit_decides_it_and_nowhere_else() -> None:
    even, won, lost = (50, 10, 10), (20, 50, 5), (20, 5, 50)
    turned = record(even, won, lost)
    assert turned.headline == (
        "A reversal was confirmed at gain:scale=0.6: new is ahead with the fault at the observer "
        "alone, old with it shared."
    )
    assert len(turned.headline.split()) <= MOST_WORDS
    for other in (record(even, even, even), record(even, won, even), record(even, won, won)):
        assert other.headline == (
            "No reversal was confirmed with the fault at the observer alone, at gain:scale=0.6."
        )
        assert "Not confirmed is not absent" in other.sentences[-1]
    untested = record(regret_pp=-40.0)
    assert (untested.best, untested.confirmed) == ("", None)
    assert untested.headline.startswith("No reversal was confirmed: no fault that was tried")


@pytest.mark.parametrize("n", [1, 2, 4])
def test_few_scenes_confirm_nothing(n: int) -> None:
    wins, losses = (0, n, 0), (0, 0, n)
    confirmed = audit({"correct": losses, "observer": wins, "shared": losses}, n)
    made = conclude(record().question, record().tried, confirmed)
    assert made.headline.startswith("No reversal was confirmed: ")
    assert "compared" in made.headline
    assert "is ahead" not in " ".join(made.sentences)
