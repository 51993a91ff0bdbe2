"""Results of which not everything is there: what both variants have is compared, and it is said."""

import numpy as np
import pytest

from faultpath.analyses.decide import decide
from faultpath.analyses.judging import pair_results
from faultpath.analyses.model import AuditResult
from faultpath.report.audit_tables import ALL, by_quantity, markdown_table
from faultpath.report.sentences import words
from faultpath.run.received.question import JudgeQuestion
from faultpath.run.received.results import Received
from faultpath.system.outcome import Status


def judged(trials: list[tuple[str, str, str]], blank: int | None = None, **asked) -> AuditResult:
    """Return the record of two variants over `trials` (task, scene, seed), the repair ahead in each
    third of them; the repair's trial number `blank` has no metric."""
    rows = [
        Received(
            f"line {place}",
            variant,
            "",
            *trial,
            Status.SUCCESS if variant == "new" or place % 3 else Status.CRASH,
            "",
            float("nan"),
            {} if (variant, place) == ("new", blank) else {"metres": place + (variant == "new")},
        )
        for variant in ("old", "new")
        for place, trial in enumerate(trials)
    ]
    question = JudgeQuestion.model_validate({"baseline": "old", "repair": "new", **asked})
    laid = pair_results(rows, question)
    return decide(laid.question, laid.facts, laid.conditions, laid.trials, laid.findings)


def test_two_scenes_with_an_extra_seed_leave_the_other_28():
    trials = [("", f"s{n}", "7") for n in range(30)]
    made = judged([*trials, ("", "s3", "1"), ("", "s4", "9")])
    whole = judged(trials)
    assert made.scenes == 30
    assert made.facts.seeds == (7,)
    assert made.effects[0].model_copy(update={"missing": None}) == whole.effects[0]
    (said,) = set(words(made).findings) - set(words(whole).findings)
    assert said == (
        "2 scenes have more trials than the others, for example s3: the extra trials are left out."
    )


def test_tasks_are_called_tasks():
    """They were scenes: of 3 tasks with 10 scenes each, "too few scenes: 3 compared"."""
    few = judged([(f"t{n % 3}", f"s{n}", "") for n in range(30)], cluster="task")
    assert words(few).headline.startswith("Too few tasks: 3 compared")
    whole = " ".join((*words(few).sentences, *words(few).would_change))
    assert "Too few tasks: 3 tasks compared" in whole
    assert "More tasks: " in whole
    assert "Tasks" in {line.label for line in by_quantity(few, ALL).lines}
    many = judged([(f"t{n % 10}", f"s{n}", "") for n in range(30)], cluster="task")
    assert markdown_table(many).startswith("**new against old: 10 tasks**")


def test_a_scene_without_a_seed_counts_by_its_other_seeds():
    trials = [("", f"s{n}", f"{seed}") for n in range(100) for seed in range(3)]
    made = judged(trials[1:])
    assert made.scenes == 100
    assert made.effects[0].void == 1
    assert len(made.effects[0].won) == 3
    assert any(
        "1 trial of new failed or is missing, 1 of old" in said for said in words(made).findings
    )


def test_tasks_with_a_scene_less_are_compared_by_what_all_tasks_have():
    trials = [(f"t{n}", f"{scene}", "") for n in range(20) for scene in range(10 - n % 2)]
    made = judged(trials, cluster="task")
    assert made.scenes == 20
    assert any("10 tasks have more trials than the others" in each for each in words(made).findings)


@pytest.mark.parametrize("seeds", [1, 2])
def test_a_metric_with_a_blank_is_told_of_the_other_scenes_and_that_is_said(seeds):
    trials = [("", f"s{n}", f"{seed}") for n in range(12) for seed in range(seeds)]
    made = judged(trials, blank=4, metrics=["metres:more"])
    assert made.secondary[0].metrics["metres"].n_scenes == 11
    assert made.secondary[0].metrics["metres"].value == 1.0
    assert any("metres is compared in 11 of 12 scenes" in each for each in words(made).findings)
    whole = judged(trials, metrics=["metres:more"])
    assert not any("metres" in each for each in words(whole).findings)
    assert np.isfinite(whole.secondary[0].metrics["metres"].value)
