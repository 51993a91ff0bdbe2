"""The claims over whole runs: as published, mirrored, in part, and not at all."""

from dataclasses import replace

import pytest
from faultpath_paper.answers import ClaimVerdict
from faultpath_paper.cells import Cell, published_claims
from faultpath_paper.claims import STATEMENTS, evaluate
from faultpath_paper.claims.statement import answered, verdict
from faultpath_paper.claims.terms import statement
from faultpath_paper.pages import table_1, table_4
from faultpath_paper.quantities.differences import together
from faultpath_paper.results import Results
from study_toys import SCENES, as_published, mirrored, whole
from toy_runs import EMPTY, NOTHING, trials

from faultpath.run.trials import Trials
from faultpath.system import Status

Answers = dict[str, ClaimVerdict]


def test_an_empty_run_leaves_every_published_claim_undecided() -> None:
    claims = evaluate(EMPTY)
    assert [claim.id for claim in claims] == [claim.id for claim in published_claims()]
    assert set(STATEMENTS) == {claim.id for claim in claims}
    assert {claim.verdict for claim in claims} == {"undecided"}
    assert all(claim.parts for claim in claims)
    assert all(part.reason.startswith("not run: ") for c in claims for part in c.parts)


def test_where_the_papers_figures_come_true_every_claim_is_confirmed(answers: Answers) -> None:
    others = {id: answer.parts for id, answer in answers.items() if answer.verdict != "confirmed"}
    assert not others


def test_turning_all_outcomes_round_refutes_what_was_detected(answers: Answers) -> None:
    """Success becomes failure and errors their inverse: each detected side is the other one."""
    turned = evaluate(whole(mirrored, power=-1.0, slower_s=-1.4))
    mirror = {claim.id: claim for claim in turned}
    detected = [
        (old, new)
        for id, statements in STATEMENTS.items()
        for statement, old, new in zip(statements, answers[id].parts, mirror[id].parts, strict=True)
        # C04 is of crashes, which do not turn round.
        if " is significantly " in statement.words and id != "C04"
    ]
    assert len(detected) > 20
    for old, new in detected:
        assert old.answer == "confirmed"
        assert new.answer == "refuted"
        if old.test:
            assert new.estimate == pytest.approx(-(old.estimate or 0))
            assert new.p_value == old.p_value


def test_a_reversal_in_two_of_three_seeds_is_none_in_every_seed() -> None:
    def ends(cell: Cell, seed: int, scene: int) -> Status:
        turned = seed == 2 and cell.variant == "gru+dcc"
        return mirrored(cell, seed, scene) if turned else as_published(cell, seed, scene)

    run = Results(trials(table_4.PAGE.cells, ends, range(SCENES)), NOTHING, "toy")
    seeds = STATEMENTS["C26"][1].part(run)
    assert (seeds.answer, seeds.estimate) == ("refuted", 2)


def test_what_was_not_run_is_named(published_run: Results) -> None:
    cell, rows = table_1.DKI, published_run.trials
    others = tuple(row for row in rows if row.variant != cell.variant)
    fewer = replace(published_run, trials=Trials.of(others))
    (part,) = (answered(statement, fewer) for statement in STATEMENTS["C03"])
    assert (part.answer, part.reason) == ("undecided", f"not run: {cell}")


def test_a_void_trial_leaves_its_scene_out_of_all_that_is_joined(published_run: Results) -> None:
    def ends(cell: Cell, seed: int, scene: int) -> Status:
        lost = cell == table_4.cell("gru", "shared") and seed == 1 and scene in (0, 60)
        return Status.FAILED if lost else as_published(cell, seed, scene)

    run = Results(trials(table_4.PAGE.cells, ends, range(SCENES)), NOTHING, "toy")
    repaired = [
        (table_4.cell("gru+dcc", condition), table_4.cell("gru", condition))
        for condition in ("reconstruction-only", "shared")
    ]
    for effect in together(run, *repaired):
        assert effect.n_scenes == SCENES - 2


def test_no_rule_knows_what_the_paper_reports(answers: Answers, published_run: Results) -> None:
    """A claim with other published words gets the same answer."""
    claim = published_claims()[4]
    other = claim.model_copy(update={"paper": "69 -> 0"})
    found = verdict(other, STATEMENTS[claim.id], published_run)
    assert found.parts == answers[claim.id].parts


@pytest.mark.parametrize(
    ("entry", "mistake"),
    [
        ({"success": ["table-9 gru shared", "table-4 gru shared"]}, "'table-9 gru shared' is no"),
        ({"success": ["table-4 gru", "table-4 gru shared"]}, "'table-4 gru' is no term"),
        ({"failure": ["table-4 gru shared"]}, "'failure: .* is no quantity"),
    ],
)
def test_a_statement_about_what_there_is_not_is_refused(entry, mistake) -> None:
    with pytest.raises(ValueError, match=mistake):
        statement("it is significantly above 0", entry)
