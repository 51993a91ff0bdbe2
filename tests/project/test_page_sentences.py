"""Sentences of pages beside their tables follow from results: typed sentences and written ones."""

import json
import re
from pathlib import Path

import blocks
import comparison
import numpy as np
import pytest
import state_study
import studies
from blocks import REFERENCE, ROOT
from comparison import ALONE, MISSED, OPEN, REVERSAL, SAME, SIZE, Effect, verdict
from documents import BLOCK, BLOCKS, documents
from faultpath_paper.answers import shipped_ledger
from faultpath_paper.cells import published_claims
from faultpath_paper.claims import SUBJECTS
from faultpath_paper.report.words import is_non_detection
from state_design import Audit, Design
from studies import sensor_sentences, sensors

from faultpath.analyses.family import decide_conditions

PAGES = [path for path in documents() if BLOCK.search(path.read_text("utf-8"))]
FENCE = re.compile(r"^```.*?^```$", flags=re.MULTILINE | re.DOTALL)
NONE_IS = re.compile(
    r"\bno other\b.*\bsignifican"
    r"|\b(no|nothing|none|neither)\b( \S+){0,4} (is|are|was|were) (\w+ )?significan"
    r"|\bsignificant: (everything|all) else",
    flags=re.IGNORECASE,
)
UNLESS = re.compile(r"\b(where|when|if|which|that|whether|because)\b", flags=re.IGNORECASE)
"""Begins a clause that defines or supposes, and states nothing of a run."""
NO_REVERSAL = re.compile(r"\bno reversal was\b|\bdid not reverse\b|\bno ranking reversed\b")


def typed(text: str) -> list[str]:
    """Return the sentences of a page that no command writes."""
    prose = FENCE.sub("", BLOCK.sub("\n\n", text))
    paragraphs = re.split(r"\n\n|\n(?=[-#|])", prose)
    return [s for part in paragraphs for s in re.split(r"(?<=[.;?]) ", part.replace("\n", " "))]


def nulls(text: str) -> list[str]:
    """Return the typed sentences which say that nothing, or nothing else, is significant."""
    hits = ((sentence, NONE_IS.search(sentence)) for sentence in typed(text))
    return [s for s, hit in hits if hit and not UNLESS.search(s[: hit.end()])]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_that_nothing_else_is_significant_is_only_said_by_results(page: Path) -> None:
    """A table beside a typed sentence changes with its run, and the sentence does not."""
    text = page.read_text("utf-8")
    assert nulls(text) == []
    if any(NO_REVERSAL.search(sentence) for sentence in typed(text)):
        names = {match["name"].split(":")[1] for match in BLOCK.finditer(text)}
        records = [path for name in names for path in REFERENCE.glob(f"{name}*/record.json")]
        assert records
        changes = [
            change for path in records for change in json.loads(path.read_bytes())["changes"]
        ]
        assert "reversal" not in {change["turn"] for change in changes}


@pytest.mark.parametrize(
    ("sentence", "states"),
    [
        ("In rooms a smear did, and for no other error was the difference significant.", True),
        ("With both, no gain is significant.", True),
        ("Nothing is significant.", True),
        ("- **Not significant: everything else.** Under it", True),
        ("Neither is significantly ahead.", True),
        ("With both pictures its gain is not significant.", False),
        ("It is zero where nothing is significant.", False),
        ("Correlations at which neither is significantly ahead.", False),
    ],
)
def test_sentences_that_deny_an_effect_are_known(sentence: str, states: bool) -> None:
    assert bool(nulls(sentence)) == states
    generated = f"<!-- begin:latent:effects:x -->\n{sentence}\n<!-- end:latent:effects:x -->"
    assert nulls(generated) == []


@pytest.mark.parametrize(
    ("signs", "clauses"),
    [
        ((1, 0), ["significantly more often (15 % darker)", "without a significant difference ("]),
        ((-1, -1), ["significantly less often (15 % darker and shifted by 2 px)."]),
        ((0, 0), ["without a significant difference (15 % darker and shifted by 2 px)."]),
    ],
)
def test_the_answer_about_one_camera_follows_from_its_studies(
    monkeypatch: pytest.MonkeyPatch, signs: tuple[int, int], clauses: list[str]
) -> None:
    rows = [
        {"fault": fault, "effect": [0.0, -1.0, 1.0, sign]}
        for fault, sign in zip(("darker", "moved"), signs, strict=True)
    ]
    turns = {"turns": {"observation": "reversal" if signs == (-1, -1) else "none"}}
    study = {"audits": [turns, {"turns": {}}], "baseline": rows}
    monkeypatch.setattr(studies, "figures_of", lambda *name: study)
    text = studies.camera_answer(("marked", "blank"))
    lead = (
        "A reversal is significant in 2 of 4 audits." if signs == (-1, -1) else "No reversal in 4"
    )
    assert text.startswith(lead)
    assert all(text.count(clause) == 2 for clause in clauses)
    assert text.count("significantly") == 2 * len([sign for sign in set(signs) if sign])


@pytest.mark.parametrize(
    ("alone", "shared", "turn", "word"),
    [
        (1, -1, "reversal", REVERSAL),
        (0, -1, "interaction", MISSED),
        (-1, 0, "interaction", ALONE),
        (1, 1, "interaction", SIZE),
        (1, 1, "none", SAME),
        (1, 0, "none", OPEN),
        (0, 0, "interaction", OPEN),
    ],
)
def test_only_what_is_decided_makes_a_word(alone, shared, turn, word) -> None:
    effects = (Effect(-30.0, -40.0, 40.0, sign) for sign in (alone, shared))
    assert verdict(*effects, turn) == word


def test_the_table_has_every_audit_and_the_module_that_says_least() -> None:
    head, _, *rows = BLOCKS["found"]().splitlines()
    groups = comparison.grouped()
    assert sum(map(len, groups)) == len([*comparison.every_audit()]) > len(comparison.PAGES)
    for group in groups:
        assert len({(audit.word, audit.effects["shared"].sign) for audit in group}) == 1
    assert len(rows) == len(groups)
    assert all(row.count("|") == head.count("|") for row in rows)
    docking = next(row for row in rows if "`ranges`" in row)
    assert "| speedometer **" in docking
    assert docking.endswith("| **reversal** |")


def test_every_system_has_a_row_that_counts_its_audits() -> None:
    rows = [row.split("|")[2:-1] for row in BLOCKS["counts"]().splitlines()[2:]]
    assert sum(int(audits) for audits, _ in rows) == sum(map(len, comparison.grouped()))
    for audits, answer in rows:
        counts = [int(text) for text in re.findall(r"\((\d+)\)", answer)]
        assert sum(counts) == (int(audits) if int(audits) > 1 else 0)


def test_teaching_examples_are_marked() -> None:
    marked = [system for system in comparison.by_system() if "(teaching example)" in system]
    assert len(marked) == len(studies.WORDS["teaching"])
    assert any("Cart" in system for system in marked)


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        ([REVERSAL], "no: the better version is the worse one"),
        ([OPEN, ALONE, OPEN], "no: the difference that it shows is gone (1); inconclusive (2)"),
    ],
)
def test_an_answer_counts_only_several_audits(words, answer) -> None:
    assert comparison.answer(words) == answer


def audit(scenes: int, alone: int, shared: int) -> Audit:
    """Decide an audit in which the versions differ in all scenes, to a side or (0) in none."""

    def variants(side: int):
        won, lost = (np.full((scenes, 1), side == of) for of in (1, -1))
        return won, lost

    success = {"correct": variants(0), "observer": variants(alone), "shared": variants(shared)}
    family = decide_conditions(success)
    effects = {
        n: [e.value, *(e.interval or (-100, 100)), e.sign] for n, e in family.effects.items()
    }
    turns = dict(family.turns)
    return Audit(fault="bias", repair="filter", success={}, effects=effects, turns=turns)


@pytest.mark.parametrize("scenes", [1, 2, 4])
def test_few_scenes_are_inconclusive(scenes):
    first, last = sensor_sentences([audit(scenes, 1, -1), audit(scenes, 0, 0)])
    assert "more often than the baseline in none and less often in none." in first
    assert last.startswith("No reversal was found, which does not show that there is none")
    assert "2 (filter under bias and filter under bias)" in last


DETECTS = "shows {} (significantly different from the shared effect: {})"


@pytest.mark.parametrize(
    ("effects", "helps", "harms", "detects", "reversal"),
    [
        ((1, -1), "none", "1 (filter under bias)", ("none", "1"), "A reversal was found in 1;"),
        ((0, 1), "1 (filter under bias)", "none", ("none", "1"), "No reversal was found"),
        ((1, 1), "1 (filter under bias)", "none", ("1", "none"), "No reversal was found"),
    ],
)
def test_many_scenes_say_which_side_and_what_an_isolated_test_detects(
    effects, helps, harms, detects, reversal
):
    first, alone, last = sensor_sentences([audit(40, *effects)])
    assert f"in {helps} and less often in {harms}." in first
    assert DETECTS.format(*detects) in alone
    assert last.startswith(reversal)


def test_every_audit_is_shown_once_and_a_repair_has_no_name_of_a_sensor():
    rows, audits = BLOCKS["state:effects"]().splitlines()[2:], sensors().audits
    assert len(rows) == len(audits)
    assert not {audit.repair for audit in audits} & {"accelerometer", "gyroscope"}


def test_the_design_names_what_it_flies():
    design = Design.read(blocks.ROOT / "experiments" / "state-errors" / "design.yaml")
    assert {fault for fault, _ in design.audits} <= {*design.faults}
    assert {repair for _, repair in design.audits} <= {*design.repairs}
    assert design.variants["gyroscope bias"] == {
        "gru": "eskf-no-bias",
        "wm-a-nowind": "eskf-no-bias",
        "dob-inertial": "eskf-no-bias",
        "eskf/gru": "eskf",
    }


def test_a_study_without_workers_is_refused_in_a_sentence(capsys):
    with pytest.raises(SystemExit, match="2"):
        state_study.main(["--workers", "0"])
    assert "--workers 0: give at least one" in capsys.readouterr().err


LEDGER = shipped_ledger()


def test_every_claim_stands_once_and_is_marked_where_no_detection_confirms_it() -> None:
    text = BLOCKS["paper:ledger"]()
    assert sorted(re.findall(r"C\d\d", text)) == [claim.id for claim in LEDGER.claims]
    marked = sorted(re.findall(r"(C\d\d)\\\*", text))
    assert marked == [claim.id for claim in LEDGER.claims if is_non_detection(claim)]
    assert "C02" in marked
    assert "C05" not in marked


def test_every_claim_has_one_subject_and_its_figures_add_up() -> None:
    every = [claim for claims in SUBJECTS.values() for claim in claims]
    assert sorted(every) == [claim.id for claim in published_claims()]
    rows = [row.split("|")[2:-1] for row in BLOCKS["paper:sizes"]().splitlines()[2:]]
    *subjects, last = ([int(cell) for cell in row] for row in rows)
    assert [sum(column) for column in zip(*subjects, strict=True)] == last
    assert last[0] >= sum(last[1:]) > 0


def test_what_did_not_come_out_is_told_by_the_part_that_decides() -> None:
    told = re.findall(r"^- \*\*(C\d\d), \w+\.\*\* .+: .+$", BLOCKS["paper:apart"](), re.M)
    assert told == [c.id for c in LEDGER.claims if c.verdict != "confirmed"]
