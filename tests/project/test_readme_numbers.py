"""The numbers of README and docs are those of the reference runs, and those are what runs give."""

import os
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import documents
import pytest

from faultpath.analyses.audit import AuditAnalysis, audit_analysis
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


def numbers(value: object) -> object:
    """Everything of a record that is no sentence, without the last digits of one processor."""
    if isinstance(value, AuditResult):
        return numbers(value.model_dump(exclude={"facts": {"system"}}))
    if isinstance(value, dict):
        return {key: numbers(part) for key, part in value.items() if key != "words"}
    if isinstance(value, list | tuple):
        return [numbers(part) for part in value]
    return round(value, 6) + 0.0 if isinstance(value, float) else value


def test_no_block_or_picture_is_stale(run: Callable[..., CompletedProcess[str]]) -> None:
    done = run(str(ROOT / "tools" / "documents.py"), "--check")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("name", QUICK)
def test_the_code_that_is_here_gives_the_whole_of_a_quick_reference(name: str, tmp_path) -> None:
    """Run again it is the same to the last bit; of the slow ones `test_repeats` asks a sample."""
    audit = plan(record_of(name))
    done = run_plan(audit.plan, tmp_path, workers=0)
    reference = read_outcomes(REFERENCE / name / "outcomes.parquet")
    assert (tmp_path / "outcomes.parquet").read_bytes() == encode_outcomes(reference)
    again = audit.conclude(done.trials, done.deliveries)
    assert numbers(again) == numbers(record_of(name))


def plan(record: AuditResult) -> AuditAnalysis:
    question, facts = record.question, record.facts
    assert isinstance(question, AuditQuestion)
    place = facts.system if ".py:" not in facts.system else str(ROOT / facts.system)
    spec = SystemSpec(name=place, options=question.options)
    system = load_system(spec)
    return audit_analysis(system, spec, question, system.library(facts.library))


def recipe(target: str, given: str = "") -> list[str]:
    line = ["make", "--no-print-directory", "--dry-run", "--always-make", target, f"ARGS={given}"]
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
    made = RunProvenance.model_validate_json((folder / "provenance.json").read_bytes())
    assert made.blocks_kept == 0, "its wall time is not that of the whole run"
    assert not os.path.isabs(made.command[0]), "this path names a machine"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<!-- begin:table:toy -->\n", "stands alone"),
        ("<!-- begin:table:toy -->\n<!-- end:table:dock -->", "stands alone"),
        ("<!-- begin:table:none -->\n<!-- end:table:none -->", "none/record.json is missing"),
        ("<!-- begin:tabel:toy -->\n<!-- end:tabel:toy -->", "no block 'tabel'"),
        ("<!-- begin:template:numpy:a:x -->\n<!-- end:template:numpy:a:x -->", "no part 'x'"),
    ],
)
def test_a_wrong_block_is_refused(text: str, said: str) -> None:
    with pytest.raises(documents.Wrong, match=said):
        documents.filled(text, ROOT / "README.md")
