"""Trials that other tools ran are read strictly, paired by keys, and decided as an audit's are."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from judged_files import HEADER, Successes, inspect_log, judged, lerobot, lm_eval, table
from toy_audits import AUDIT, ROOT, TOY

import faultpath
from faultpath import UserError
from faultpath.analyses.model import AS_RUN, SHARED
from faultpath.report.html import report_page
from faultpath.run.store.tables import encode_outcomes

WON: Successes = {
    "old": [n < 6 or n % 3 == 0 for n in range(30)],
    "new": [n % 5 != 0 for n in range(30)],
}
WINS = sum(b and not a for a, b in zip(*WON.values(), strict=True))
LOSSES = sum(a and not b for a, b in zip(*WON.values(), strict=True))


def test_an_audits_own_outcomes_are_decided_as_the_audit(tmp_path: Path) -> None:
    more = {"scenes": 40, "signals": False, "folder": tmp_path / "run"}
    run = faultpath.audit(TOY, **AUDIT | more)
    columns = {"variant": "variant", "condition": "condition", "success": "status"}
    named = {"columns": columns | {"initial": "initial_hash"}}
    named["metrics"] = ["terminal_distance_m:less"]
    results, folder = tmp_path / "run" / "outcomes.parquet", tmp_path / "judged"
    again = judged(results, folder, baseline="calibrated", repair="blind", **named)

    for one, two in zip(run.record.secondary, again.record.secondary, strict=True):
        assert two.metrics["terminal_distance_m"].value == one.metrics["terminal_distance_m"].value
    for one, two in zip(run.record.effects, again.record.effects, strict=True):
        for name in ("sign", "won", "p_value", "corrected_p", "rates"):
            assert getattr(one, name) == getattr(two, name), (one.condition, name)
        assert (one.low, one.high) == (two.low, two.high)
    turns = [[each.turn for each in each.record.changes] for each in (run, again)]
    assert turns[0] == turns[1]
    assert "reversal" in turns[1]
    assert again.headline == run.headline
    assert again.record.facts.pairing == "hashes"
    assert list(again.provenance.code.data) == [str(results)]

    opened = faultpath.open_run(folder)
    assert opened.record == again.record
    assert encode_outcomes(opened.inputs.trials) == encode_outcomes(again.inputs.trials)
    assert report_page(opened.inputs) == report_page(again.inputs)
    page = (folder / "report.html").read_text()
    assert "Other tools ran the trials" in page
    assert "Only what a tap delivers" not in page
    assert str(results) in page
    assert (
        json.loads((tmp_path / "run" / "record.json").read_text())["facts"]["pairing"] == "planned"
    )


KINDS: dict[str, tuple[Callable[[Path, str, Any], str], str, dict[str, Any]]] = {
    "lerobot": (lambda p, variant, won: variant + lerobot(p / variant, won), "keys", {}),
    "lerobot, one task": (
        lambda p, variant, won: variant + lerobot(p / variant, won, True),
        "keys",
        {},
    ),
    "inspect": (lambda p, variant, won: inspect_log(p / variant, variant, won), "hashes", {}),
    "lm-eval": (
        lambda p, variant, won: variant + lm_eval(p / variant, won),
        "hashes",
        {"columns": ["success=exact_match,strict-match"]},
    ),
}


@pytest.mark.usefixtures("without_pages")
@pytest.mark.parametrize(("write", "pairing", "more"), KINDS.values(), ids=KINDS)
def test_what_other_tools_write_is_read(
    write: Callable[[Path, str, Any], str], pairing: str, more: dict[str, Any], tmp_path: Path
) -> None:
    run = judged([write(tmp_path, *each) for each in WON.items()], tmp_path / "run", **more)
    (effect,) = run.record.effects
    assert (effect.condition, effect.scenes) == (AS_RUN, 30)
    assert effect.won == ((WINS, LOSSES),)
    assert run.record.secondary[0].time_s is None
    assert run.record.facts.pairing == pairing
    assert run.table().column("time_s").null_count == 60
    text = " ".join(run.sentences)
    assert ("by their keys alone" in text) == (pairing == "keys")
    assert "correct inputs" not in text + run.headline


@pytest.mark.usefixtures("without_pages")
def test_a_folder_judged_anew_is_that_of_the_last_results(tmp_path: Path) -> None:
    for scenes in (10, 20):
        some = {variant: won[:scenes] for variant, won in WON.items()}
        run = judged(table(tmp_path / "all.csv", {"nominal": some}), tmp_path / "run")
        again = faultpath.open_run(run.folder)
        assert (again.record, again.provenance) == (run.record, run.provenance)
        assert again.record.facts.n_scenes == scenes


@pytest.mark.parametrize("name", ["toy", "map-toy", "scan-toy"])
def test_no_run_of_trials_is_judged_over(name: str, tmp_path: Path) -> None:
    """As it is handed on: without what an unfinished one goes on from."""
    folder = Path(shutil.copytree(ROOT / "docs" / "reference" / name, tmp_path / "run"))
    before = {path: path.read_bytes() for path in folder.iterdir()}
    with pytest.raises(UserError, match="run holds a run that is no judgement"):
        judged(table(tmp_path / "all.csv", {"nominal": WON}), folder)
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def test_missing_pairs_are_named_and_bound_what_is_decided(tmp_path: Path) -> None:
    better: Successes = {"old": [False] * 12 + [True] * 8, "new": [True] * 20}
    file = table(tmp_path / "all.csv", {"nominal": better, "shared": better})
    whole = judged(file, tmp_path / "whole")
    assert [effect.sign for effect in whole.record.effects] == [1, 1]

    lines = file.read_text().splitlines(keepends=True)
    alone = [line for line in lines if line.startswith("new") and "shared" in line][:9]
    both = [line for line in lines if ",s19,0,nominal" in line]
    file.write_text("".join(line for line in lines if line not in (*alone, *both)))
    run = judged(file, tmp_path / "run")
    nominal, shared = run.record.effects
    assert (shared.condition, shared.void, shared.scenes) == (SHARED, 9, 11)
    for effect, against, favour in ((nominal, 55.0, 65.0), (shared, 15.0, 60.0)):
        assert effect.missing is not None
        assert effect.missing.against_pp == pytest.approx(against)
        assert effect.missing.favour_pp == pytest.approx(favour)
    assert not shared.sign
    findings = " ".join(run.words.findings)
    assert "Under the shared fault, 9 trials of new are missing, for example that in s0" in findings
    assert "1 trial of old is missing, for example that in s19 (seed 0)" in findings
    assert run.failed == 11


def test_trials_that_began_otherwise_are_no_pair(tmp_path: Path) -> None:
    file = table(tmp_path / "all.csv", {"": WON})
    file.write_text(file.read_text().replace("new,s3,0,,1,h3", "new,s3,0,,1,other"))
    run = judged(file, tmp_path / "run")
    assert run.record.effects[0].void == 1
    assert run.headline == "No result: the two versions did not meet the same conditions."
    assert run.broken
    assert any("are no pair in scene 's3'" in finding for finding in run.words.findings)


def test_a_task_with_all_of_its_scenes_is_one_of_few(tmp_path: Path) -> None:
    lines = [
        f"{variant},{task}/{n},,,{int(won and task != 't1')},h,{task}"
        for task in ("t0", "t1", "t2")
        for variant, each in WON.items()
        for n, won in enumerate(each)
    ]
    header = HEADER.replace("\n", ",task\n")
    (file := tmp_path / "all.csv").write_text(header + "\n".join(lines))
    run = judged(file, tmp_path / "run", cluster="task")
    assert run.record.scenes == 3
    assert len(run.record.effects[0].won) == 30  # though many of them came out alike
    assert "new tasks like these" in " ".join(run.sentences)
    assert run.headline.startswith("Too few tasks")
    by_scene = judged(file, tmp_path / "scenes")
    assert any("--cluster task" in finding for finding in by_scene.words.findings)


@pytest.mark.usefixtures("without_pages")
@pytest.mark.parametrize("n", [1, 2, 4])
@pytest.mark.parametrize("won", [(True, False), (True, True)])
def test_few_scenes_and_ties_claim_nothing(n: int, won: tuple[bool, bool], tmp_path: Path) -> None:
    variants = {"old": [won[0]] * n, "new": [won[1]] * n}
    run = judged(table(tmp_path / "few.csv", {"": variants}), tmp_path / "run")
    assert run.headline.startswith("Too few scenes")
    assert not any("more often" in sentence for sentence in run.sentences)


ROW = "old,s0,0,,1,h\nnew,s0,0,,1,h\n"
MISTAKES = yaml.safe_load(Path(__file__).with_name("mistakes.yaml").read_text("utf-8"))["judge"]


@pytest.mark.parametrize(("question", "sentence"), MISTAKES)
def test_what_cannot_be_judged_is_refused(
    question: dict[str, Any], sentence: str, tmp_path: Path
) -> None:
    table = {"header": HEADER, "rows": ROW} | question
    (file := tmp_path / "all.csv").write_text(f"{table.pop('header').strip()}\n{table.pop('rows')}")
    with pytest.raises(UserError, match=sentence):
        judged(file, tmp_path / "run", **table)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("conditions", "noticed"),
    [
        (("nominal", "both", "perception"), True),
        (("nominal", "shared", "perception"), False),
        (("nominal", "perception"), False),
    ],
)
def test_a_shared_condition_of_another_name_is_asked_for(
    conditions: tuple[str, ...], noticed: bool, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    file = table(tmp_path / "all.csv", dict.fromkeys(conditions, WON))
    judged(file, tmp_path / "run")
    sentence = (
        "No condition is named 'shared': 'both' and 'perception' are taken as modules; give "
        "shared='both' if it has the fault at every module."
    )
    assert (sentence in caplog.text) == noticed


def test_seeds_that_are_one_number_are_two_labels(tmp_path: Path) -> None:
    (file := tmp_path / "all.csv").write_text(HEADER + ROW + ROW.replace(",0,", ",00,"))
    record = judged(file, tmp_path / "run").record
    assert record.facts.seeds == (0, 1)
    assert record.counts[0].trials == 2


def test_the_largest_numbers_that_are_read_can_be_added_up(tmp_path: Path) -> None:
    trials = [(variant, n, won) for variant, each in WON.items() for n, won in enumerate(each)]
    rows = [
        f"{variant},{n},{won},1e300,{'-' * (variant == 'old')}1e300\n" for variant, n, won in trials
    ]
    (file := tmp_path / "all.csv").write_text(
        "variant,scene,success,time_s,reward\n" + "".join(rows)
    )
    judged(file, tmp_path / "run", metrics="reward")
    assert "Infinity" not in (tmp_path / "run" / "record.json").read_text()


def test_a_table_of_a_spreadsheet_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    plain, marked = (tmp_path / name for name in ("plain.csv", "marked.csv"))
    plain.write_text(HEADER + ROW)
    marked.write_text(HEADER + ROW, encoding="utf-8-sig")
    one, two = (judged(file, tmp_path / file.stem).record for file in (plain, marked))
    assert one.effects == two.effects


@pytest.mark.parametrize("stored", ["", "{}", '{"format": 2}'])
def test_an_earlier_result_that_cannot_be_read_is_not_taken_for_none(
    stored: str, tmp_path: Path
) -> None:
    results = table(tmp_path / "all.csv", {"nominal": {"old": [True, False], "new": [True, True]}})
    judged(results, tmp_path / "run")
    (tmp_path / "run" / "record.json").write_text(stored)
    with pytest.raises(UserError, match="is damaged or from another version"):
        judged(results, tmp_path / "run")
    assert (tmp_path / "run" / "record.json").read_text() == stored
