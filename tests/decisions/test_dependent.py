"""Groups with one cause, the evidence that audits give of them, and the break-even beta."""

import re
from dataclasses import replace

import numpy as np
import pytest
from declared_toy import Declared, Logged
from outcome_tables import CORRECT, SHARED, arms, record, three

import faultpath
from faultpath.core.streams import generator
from faultpath.decisions.dependent import DependentGroup, dependent_groups
from faultpath.decisions.plan.plan import make_plan
from faultpath.interface import read_interface
from faultpath.report.dependent import dependent_table, of_runs
from faultpath.trials import Status, SystemSpec, Variant
from faultpath.trials.question import PlanQuestion

FACTS = """
name: chain
sources:
- {name: mass, unit: kg, provenance: estimated, correlation_group: calibration}
- {name: thrust, unit: N, provenance: estimated, correlation_group: calibration}
- {name: gyro, unit: rad/s, provenance: measured}
- {name: lone, unit: m, provenance: measured}
- {name: truth, unit: m, provenance: privileged}
- {name: attitude, unit: '1', provenance: reconstructed}
- {name: wind, unit: m/s, provenance: reconstructed}
channels:
- {name: mass, sources: [mass], consumers: [model.mass]}
- {name: thrust, sources: [thrust], consumers: [planner.thrust]}
- {name: rate, sources: [gyro], consumers: [filter.rate]}
- {name: lone, sources: [lone, truth], consumers: [planner.place]}
- {name: attitude, sources: [attitude], consumers: [observer.attitude]}
- {name: wind, sources: [wind], consumers: [planner.wind, model.wind]}
reconstructs: {filter: attitude, observer: wind}
"""
EVERY = frozenset(
    ["model.mass", "planner.thrust", "filter.rate", "planner.place", "observer.attitude"]
)
WIND = frozenset({"planner.wind", "model.wind"})


def groups(*consumers: frozenset[str]) -> dict[str, DependentGroup]:
    variants = [Variant(str(i), "", each) for i, each in enumerate(consumers)]
    return {each.name: each for each in dependent_groups(read_interface(FACTS), variants)}


def test_a_group_is_a_source_a_cause_or_what_reconstructions_pass_on() -> None:
    found = groups(EVERY, EVERY | WIND)
    assert list(found) == ["calibration", "gyro", "attitude", "wind"]  # one reader has no group
    assert found["calibration"].modules == ("model", "planner")
    assert "one cause of 2 sources" in found["calibration"].coupling
    (alone,) = found["gyro"].ways
    assert alone.taps == (("rate", "filter.rate"),)
    assert alone.passed_on == ("observer.attitude", "planner.wind", "model.wind")
    assert [way.path for way in found["wind"].ways] == ["planner", "model", SHARED]
    assert set(groups(EVERY)) == {"calibration", "gyro"}  # nobody reads the wind


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> list[faultpath.Run]:
    asked = {"baseline": "blind", "repair": "logged", "library": "carts", "scenes": 8}
    asked |= {"signals": False, "progress": False}
    place = tmp_path_factory.mktemp("runs")
    return [
        faultpath.audit(Logged(), fault=fault, folder=place / str(number), **asked)
        for number, fault in enumerate(("gain:scale=0.6", "velocity:offset=0.1@controller"))
    ]


def test_an_audit_is_evidence_for_the_arms_that_it_flew_and_no_others(runs) -> None:
    table = of_runs([run.held for run in runs], ["1", "2"])
    assert table is not None
    told = {name: {line.label: line for line in lines} for name, lines in table.blocks()}
    gain, speed = (next(of for n, of in told.items() if n.startswith(s)) for s in ("gain", "speed"))
    assert [*gain] == ["controller alone", "logger alone", "all of them (shared)"]
    for line in gain.values():
        assert line.entries[3].text.startswith("1: run, nothing significant")
        assert line.entries[-1].text == "–"  # nothing is left to fly
    assert speed["controller alone"].entries[3].text.startswith("2: run, ")
    assert speed["observer alone"].entries[3].text == "no evidence"
    assert speed["all of them (shared)"].entries[3].text == "no evidence"
    assert "--fault velocity:offset=0.1 --library carts" in speed["observer alone"].entries[-1].text
    assert "no compliance" in " ".join(table.notes).lower()


def test_only_what_is_decided_is_called_evidence_for_an_arm(runs) -> None:
    first = runs[0].held
    made = three((50, 0, 0), (30, 40, 0), (30, 0, 0))
    (_, effect, _) = made.effects
    assert effect.detected
    effects = tuple(
        effect.model_copy(update={"path": path.name, "sign": 0 if path.name == SHARED else 1})
        for path in first.record.paths
    )
    held = replace(first, record=first.record.model_copy(update={"effects": effects}))
    alone, _, shared, *_ = (e[3].text for line in of_runs([held]).lines if (e := line.entries))
    assert (alone, shared) == ("logged succeeds more often", "run, nothing significant")
    lost = replace(first, record=first.record.model_copy(update={"effects": ()}))
    entries = next(line.entries for line in of_runs([lost]).lines if line.entries)
    assert entries[3].text == "run, no pair of trials left"


def test_a_plan_has_no_evidence_and_the_command_to_get_it() -> None:
    system = Declared()
    question = PlanQuestion(baseline="calibrated", repair="blind", library="carts", scenes=2)
    spec = SystemSpec(name="my toy.py:create", options={"wind": "L3"})
    plan = make_plan(system, spec, question, system.library("carts"))
    table = dependent_table(plan.dependent, plan.study)
    first, second, *_ = (line.entries for line in table.lines if line.entries)
    assert first[3].text == "no evidence"
    assert first[-1].text == (
        "faultpath audit 'my toy.py:create' --baseline calibrated --repair blind "
        "--fault gain:scale=1.25 --library carts --set wind=L3"
    )
    assert second[-1].text == "the same audit"


def _difference(counts: tuple[int, int, int]) -> np.ndarray:
    repair, baseline = (np.array([s is Status.SUCCESS for s in of]) for of in arms(counts).values())
    return repair.astype(int) - baseline


def test_break_even_beta_is_where_simulated_faults_leave_both_arms_even() -> None:
    """A fault strikes the module alone, or with the share beta all modules: one at a time."""
    isolated, shared = (30, 28, 4), (30, 2, 40)
    (found,) = three((50, 0, 0), isolated, shared).break_even_beta
    assert found.path == "observer"
    beta = found.result.p_star
    assert beta == pytest.approx(24 / 62)
    assert [region.sign for region in found.result.regions] == [1, -1]
    draw = generator("beta", "", 0)
    episodes = 200_000

    def simulated(share: float) -> float:
        common = draw.random(episodes) < share
        scene = draw.integers(100, size=episodes)
        alone, all_ = (_difference(counts)[scene] for counts in (isolated, shared))
        return 100 * float(np.where(common, all_, alone).mean())

    assert simulated(beta) == pytest.approx(0.0, abs=0.7)
    for share, expected, *_ in found.curve[::10]:
        assert simulated(share) == pytest.approx(expected, abs=0.7)


@pytest.mark.parametrize(
    ("isolated", "shared", "said"),
    [
        ((30, 24, 0), (30, 0, 24), r"new is ahead up to \d+ %, old is ahead from \d+ % on"),
        ((30, 24, 0), (30, 24, 0), "new is ahead at every beta"),
        ((50, 0, 0), (50, 0, 0), "^$"),
        ((50, 2, 1), (30, 30, 0), r"new is ahead from \d+ % on|where most of its faults"),
    ],
    ids=["turns", "never", "ties", "one end"],
)
def test_beta_is_said_where_it_is_decided(isolated, shared, said) -> None:
    (found,) = three((50, 0, 0), isolated, shared).break_even_beta
    assert re.search(said, found.words)
    assert record({CORRECT: (50, 0, 0), "observer": isolated}).break_even_beta == ()


@pytest.mark.parametrize("scenes", [1, 2, 4])
def test_few_scenes_say_nothing_of_beta(scenes: int) -> None:
    cells = {CORRECT: (scenes, 0, 0), "observer": (0, scenes, 0), SHARED: (0, 0, scenes)}
    (found,) = record(cells, scenes).break_even_beta
    assert (found.words, found.result.kind) == ("", "whole")
