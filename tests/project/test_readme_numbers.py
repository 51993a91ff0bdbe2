"""The numbers of README and docs are those of the reference runs, and those are what runs give."""

import os
import re
import subprocess
from pathlib import Path

import documents
import pytest

from faultpath.analyses.audit import audit_analysis
from faultpath.analyses.model import AuditResult
from faultpath.run.execution.runner import run_plan
from faultpath.run.plan import SystemSpec
from faultpath.run.provenance import RunProvenance
from faultpath.run.question import AuditQuestion
from faultpath.run.registry import load_system
from faultpath.run.store.folder import read_outcomes
from faultpath.run.store.tables import encode_outcomes

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "docs" / "reference"
RUNS = sorted(path.parent for path in REFERENCE.glob("*/record.json"))
QUICK = ["toy", "dock"]


def record_of(run: str) -> AuditResult:
    return AuditResult.model_validate_json((REFERENCE / run / "record.json").read_bytes())


def test_no_block_or_picture_is_stale(capsys: pytest.CaptureFixture[str]) -> None:
    assert documents.main(["--check"]) == 0, capsys.readouterr()


@pytest.mark.parametrize("name", QUICK)
def test_the_code_that_is_here_gives_the_trials_of_a_quick_reference(name: str, tmp_path) -> None:
    """To the last bit; of the slow ones `test_repeats` runs a sample, and `test_conclude` decides
    the results of all anew."""
    record = record_of(name)
    assert isinstance(record.question, AuditQuestion)
    spec = SystemSpec(name=str(ROOT / record.facts.system), options=record.question.options)
    system = load_system(spec)
    library = system.library(record.facts.library)
    run_plan(audit_analysis(system, spec, record.question, library).plan, tmp_path, workers=0)
    reference = read_outcomes(REFERENCE / name / "outcomes.parquet")
    assert (tmp_path / "outcomes.parquet").read_bytes() == encode_outcomes(reference)


def recipe(target: str, options: str = "") -> list[str]:
    line = ["make", "--no-print-directory", "--dry-run", "--always-make", target, f"ARGS={options}"]
    shown = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    (words,) = re.findall(r"faultpath audit quadrotor (.*)", shown.replace("\\\n", ""))
    return words.split()


def test_make_runs_the_main_references() -> None:
    record, words = record_of("quadrotor-L3"), recipe("audit")
    question, facts = record.question, record.facts
    assert (facts.system, facts.seeds) == ("quadrotor", (0,))
    assert dict(zip(words[::2], words[1::2], strict=True)) == {
        "--baseline": question.baseline,
        "--repair": question.repair,
        "--fault": str(question.fault),
        "--library": facts.library,
        "--wind": question.options["wind"],
    }
    confirm, decision = (
        dict(zip(words[::2], words[1::2], strict=True))
        for words in map(recipe, ("confirm", "decision"))
    )
    assert decision == confirm | {"--library": "decision", "--seeds": "0,1,2,3,4,5"}


@pytest.mark.parametrize("given", ["--wind L0 --seeds 0,1", "--wind=L0"])
def test_make_audit_gives_what_its_user_does_not(given: str) -> None:
    words = recipe("audit", given)
    assert " ".join(words).endswith(given)
    options = [word.partition("=")[0] for word in words if word.startswith("--")]
    assert sorted(options) == sorted(set(options))
    assert {"--baseline", "--repair", "--fault", "--library", "--wind"} <= set(options)


@pytest.mark.parametrize("folder", RUNS, ids=lambda path: path.name)
def test_a_reference_run_was_made_in_one_go(folder: Path) -> None:
    provenance = RunProvenance.model_validate_json((folder / "provenance.json").read_bytes())
    assert provenance.blocks_kept == 0, "its wall time is not that of the whole run"
    assert not os.path.isabs(provenance.command[0]), "this path names a machine"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("<!-- begin:table:toy -->\n", "stands alone"),
        ("<!-- begin:table:toy -->\n<!-- end:table:dock -->", "stands alone"),
        ("<!-- begin:table:none -->\n<!-- end:table:none -->", "none/record.json is missing"),
        ("<!-- begin:tabel:toy -->\n<!-- end:tabel:toy -->", "no block 'tabel'"),
        ("<!-- begin:template:numpy:a:x -->\n<!-- end:template:numpy:a:x -->", "no part 'x'"),
    ],
)
def test_a_wrong_block_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(documents.Wrong, match=sentence):
        documents.filled(text, ROOT / "README.md")
