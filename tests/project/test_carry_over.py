"""The study of where verdicts carry over: what is said comes from decisions, and it resumes."""

import blocks
import numpy as np
import pytest
import study
from carry_design import Cell, Design, Flown
from carry_verdicts import lead, moves, overall, sentences, settled, sign
from documents import BLOCKS

from faultpath.api.display import Display
from faultpath.core.errors import Stopped, UserError

ROOT = blocks.ROOT
WINDS, SIGNS = ("L2", "L3"), ("+", "-")
ALL, NONE, TIE = ("0", "1"), ("1", "0"), ("01", "10")
"""What baseline and repair are made of: the repair ahead in all scenes, in none, in every other."""


def design(scenes: int = 40) -> Design:
    whole = Design.read(ROOT / "experiments" / "carry-over" / "design.yaml")
    only = {"plant": ("torch",), "estimator": ("exact",), "wind": WINDS, "size": ("0.2",)}
    few = whole.restricted(only, scenes)
    return few.model_copy(update={"questions": few.questions[2:]})


def flown(scenes: int, **of: tuple[str, str]) -> Flown:
    """Return what a made-up study left of GRU and its repair; `of` says how by planner."""
    cells = tuple(
        Cell(
            levels={**dict.fromkeys(("plant", "estimator", "size"), "torch"), **levels},
            baseline="gru",
            repair="gru+dcc",
            reach=reach,
            ended=tuple((each * scenes)[:scenes] for each in of[levels["planner"]]),
        )
        for reach in ("isolated", "shared")
        for planner in of
        for wind in WINDS
        for direction in SIGNS
        for levels in [{"planner": planner, "wind": wind, "sign": direction}]
    )
    few = design(max(1, scenes))
    few = few.model_copy(update={"questions": few.questions[:1]})
    return Flown(
        design=few, left_out={}, options={}, cells=cells, trials=0, rounds=(), complete=True
    )


@pytest.mark.parametrize("scenes", [0, 1, 2, 4])
@pytest.mark.parametrize("successes", [ALL, NONE, TIE])
def test_of_few_scenes_nothing_is_said_but_that_nothing_is_decided(scenes, successes):
    for sentence in sentences(flown(scenes, mppi=successes, cem=NONE)):
        assert sentence.endswith("inconclusive in all 8 cells. No factor changes it significantly.")


def test_nothing_run_a_tie_and_a_failed_trial_decide_nothing():
    assert sentences(flown(0)) == ["gru+dcc against gru, reconstruction only: not flown."]
    assert "inconclusive in all 8 cells" in sentences(flown(40, mppi=TIE, cem=TIE))[0]
    broken = flown(40, mppi=(f"{'0' * 39}x", "1"), cem=TIE)
    assert "inconclusive in all 8 cells" in sentences(broken)[0]


def test_verdicts_carry_over_only_where_they_are_decided_so():
    alone, shared = sentences(flown(40, mppi=ALL, cem=ALL))
    assert "carries over: gru+dcc is ahead in all 8 cells. On the mean" in alone
    assert "does not carry over: gru is ahead in none of 8 cells, gru+dcc in 8." in shared
    alone, _ = sentences(flown(40, mppi=ALL, cem=TIE))
    assert "inconclusive in some cells: gru+dcc is ahead in 4 of 8 cells, gru in none." in alone
    assert "Opposite" not in alone
    assert "From planner mppi to cem the mean difference moves to gru." in alone


def test_a_factor_changes_a_verdict_where_both_sides_are_decided():
    results = flown(40, mppi=ALL, cem=NONE)
    opposite = "Opposite sides are significantly ahead with planner mppi and cem, in 4 of 4 pairs"
    assert opposite in sentences(results)[0]
    by = {(move.reach, move.factor): move for move in moves(results)}
    assert (by["shared", "planner"].opposite, by["shared", "planner"].change.sign) == (4, -1)
    assert (by["shared", "wind"].same, by["shared", "wind"].change.sign) == (4, 0)
    assert [mean.sign for _, _, mean in overall(results)] == [0, 0]


def test_a_cell_that_is_given_up_could_not_have_been_decided():
    plan, stream = design(), np.random.default_rng(0)
    given_up = 0
    for _ in range(200):
        ended = ["".join(map(str, stream.integers(0, 2, 30))) for _ in range(2)]
        cell = Cell(levels={}, baseline="gru", repair="gru+dcc", reach="shared", ended=ended)
        if settled(plan, cell, 10) and not lead(plan, cell):
            given_up += 1
            more = np.append(cell.differences, stream.integers(-1, 2, 10))
            assert not sign(more, plan.needed["gru", "gru+dcc"])
    assert given_up > 20


def test_a_design_with_an_unknown_level_is_refused(tmp_path):
    text = (ROOT / "experiments" / "carry-over" / "design.yaml").read_text("utf-8")
    (tmp_path / "design.yaml").write_text(text.replace("[L2, L3]", "[L2, L4]"), "utf-8")
    with pytest.raises(UserError, match="no level 'L4' of 'wind'"):
        Design.read(tmp_path / "design.yaml")


def test_what_is_stopped_resumes_and_a_variant_of_two_questions_flies_once(tmp_path, monkeypatch):
    monkeypatch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", 3)
    monkeypatch.chdir(ROOT)
    plan = design(2).restricted({"planner": ("mppi",), "wind": ("L3",), "sign": ("+",)})
    plan = plan.model_copy(
        update={"factors": {**plan.factors, "planner": {"mppi": {}, "rrt": {"planner": "rrt"}}}}
    )
    whole = study.fly(plan, tmp_path / "whole", 0, "local", Display())
    assert "choose one of mppi" in whole.left_out["planner rrt"]
    assert len(whole.cells) == 4  # two questions, isolated and shared
    assert whole.trials == sum(each.trials for each in whole.rounds) == 2 * 3 * 2

    run, calls = study.run_plan, []

    def interrupted(*arguments, progress, **options):
        def stop(now):
            calls.append(now)
            if len(calls) == 3:
                raise KeyboardInterrupt
            progress(now)

        return run(*arguments, progress=stop, **options)

    monkeypatch.setattr(study, "run_plan", interrupted)
    with pytest.raises(Stopped):
        study.fly(plan, tmp_path / "stopped", 0, "local", Display())
    resumed = study.fly(plan, tmp_path / "stopped", 0, "local", Display())
    assert resumed.cells == whole.cells
    assert sum(each.trials for each in resumed.rounds) < whole.trials

    monkeypatch.setattr(blocks, "REFERENCE", tmp_path)
    assert "4 cells" in BLOCKS["carry:cost"]("whole")
    assert "Left out: planner rrt" in BLOCKS["carry:cost"]("whole")
    assert "| cells | 1 | 1 | 1 | 1 |" in BLOCKS["carry:table"]("whole")
    assert "inconclusive in the only cell" in BLOCKS["carry:said"]("whole")
