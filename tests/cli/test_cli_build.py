"""What an audit leaves for a build: exit status, JUnit's XML, a summary; and asserts in pytest."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest
from cli_runs import ROOT, TOY, Ended, audit, faultpath

from faultpath import open_run
from faultpath.core.errors import UserError
from faultpath.report.gate import ASKS

COLUMNS = {
    "variant": "variant",
    "condition": "condition",
    "success": "status",
    "initial": "initial_hash",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("build")
    (place / "summary.md").write_text("Before.\n")
    line = [part for name in ("reversal", "repair-behind", "void") for part in ("--fail-if", name)]
    line += ["--summary", place / "summary.md", "--junit", place / "junit.xml", "--no-signals"]
    done = audit(*line, scenes=40, out=place / "run")
    assert done.status == 1, done.err
    (place / "out.txt").write_text(done.out)
    return place


def test_a_build_fails_for_what_was_found_and_leaves_its_files(folder: Path) -> None:
    out = " ".join((folder / "out.txt").read_text().split())
    assert "--fail-if reversal: Sharing the fault reverses the ranking" in out
    assert "--fail-if repair-behind: Under the shared fault" in out
    assert "--fail-if void" not in out

    (suite,) = ElementTree.parse(folder / "junit.xml").getroot()
    cases = {case.get("name"): case.find("failure") for case in suite.iter("testcase")}
    failed = {name for name, failure in cases.items() if failure is not None}
    assert set(cases) == {"trials-ran", "result", "no-reversal", "no-repair-behind", "no-void"}
    assert failed == {"no-reversal", "no-repair-behind"}
    assert (suite.get("tests"), suite.get("failures")) == ("5", "2")

    text = (folder / "summary.md").read_text()
    assert text.startswith("Before.\n### Do not choose by the fault at the observer alone")
    assert "- **passes** `void`" in text
    assert "- **fails** `repair-behind`: Under the shared fault" in text
    assert "| Difference, pp |" in text


def test_trials_that_do_not_repeat_give_no_result_and_fail_a_build(tmp_path: Path) -> None:
    """The length of a pole from np.random once named a winner, with exit status 0."""
    text = Path(TOY.removesuffix(":create")).read_text()
    here, there = 'generator("toy/cart", scene, 0)', "np.random.default_rng()"
    assert text.count(here) == 1
    (tmp_path / "toy.py").write_text(text.replace(here, there))
    options = {"system": f"{tmp_path / 'toy.py'}:create", "scenes": 30, "out": tmp_path / "run"}
    done = audit("--junit", tmp_path / "junit.xml", **options)
    assert done.status == 1
    assert "No result: trials do not repeat." in done.out
    assert "is ahead" not in done.out
    run = open_run(tmp_path / "run")
    assert run.record.invalid == "unrepeatable"
    assert "No result" in (tmp_path / "run" / "report.html").read_text()
    (failure,) = ElementTree.parse(tmp_path / "junit.xml").getroot().iter("failure")
    assert failure.text == run.headline


def judged(folder: Path, *arguments: object) -> Ended:
    named = [part for name, column in COLUMNS.items() for part in ("--column", f"{name}={column}")]
    results, variants = folder / "run" / "outcomes.parquet", ("--baseline", "blind", "--repair")
    return faultpath("judge", results, *variants, "calibrated", *named, *arguments)


def test_judged_trials_end_a_build_likewise(folder: Path) -> None:
    done = judged(folder, "--fail-if", "undecided", "--fail-if", "void")
    assert (done.status, done.err) == (0, "")
    assert judged(folder, "--fail-if", "reversal").status == 1
    (place,) = Path("runs").iterdir()  # the same question, asked twice
    faultpath("replay", place).refused("other tools ran these trials")
    assert faultpath("report", place, folder / "run").status == 0
    judged(folder, "--out", folder / "run").refused("is no judgement")


@pytest.mark.parametrize("name", ["build.md", "new", "step-1"])
def test_a_summary_is_added_to_markdown_and_to_the_file_of_ci(
    name: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (place := Path(name)).write_text("" if name == "new" else "Before.\n")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(Path("step-1").resolve()))
    assert judged(folder, "--summary", place).status == 0
    assert "\n### " in f"\n{place.read_text()}"
    monkeypatch.delenv("GITHUB_STEP_SUMMARY")
    if name != "build.md":
        (link := Path("link.md")).symlink_to(place.resolve())  # what it leads to is no Markdown
        judged(folder, "--summary", link).refused("link.md is there already")
        judged(folder, "--summary", place).refused(f"{name} is there already")


def test_a_run_answers_with_what_was_decided(folder: Path) -> None:
    run = open_run(folder / "run")
    answer = run.repair_holds_when_shared
    assert not answer
    assert repr(answer) == "no: Under the shared fault, calibrated succeeds more often."
    assert [bool(run.found(each)) for each in ASKS] == [True, True, False, False]
    with pytest.raises(UserError, match="unknown name 'behind'"):
        run.found("behind")


WRITTEN = """
def test_the_repair(faultpath):
    run = faultpath.audit(
        {toy!r}, baseline="calibrated", repair="blind", fault="gain:scale=0.6", library="carts",
        scenes=20, workers=0, signals=False,
    )
    assert run.found("void") or run.folder.is_dir()
    assert run.repair_holds_when_shared
"""


def test_a_test_of_ones_own_asserts_what_was_decided(tmp_path: Path) -> None:
    points = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]
    (plugin,) = points["pytest11"].values()
    (file := tmp_path / "test_mine.py").write_text(WRITTEN.format(toy=TOY))
    command = [sys.executable, "-m", "pytest", "-q", "-p", plugin, "-p", "no:cacheprovider", file]
    command += ["--basetemp", tmp_path / "inner"]  # what it clears is its own
    alone = {**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # by its entry point, once more
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=alone)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "assert no: Under the shared fault, calibrated succeeds more often." in done.stdout
    assert not (tmp_path / "runs").exists()
