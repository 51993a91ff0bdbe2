"""The GitHub action: its steps run as a runner runs them, and end a job as the audit says."""

import os
import re
import subprocess
import sys
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

pytestmark = pytest.mark.slow  # all together

ROOT = Path(__file__).resolve().parents[2]
ACTION = yaml.safe_load((ROOT / "action.yml").read_text("utf-8"))
INSTALL, *STEPS = ACTION["runs"]["steps"]
EXPRESSION = re.compile(r"\$\{\{\s*(.*?)\s*\}\}")
TOY = {
    "system": "examples/toy.py:create",
    "baseline": "calibrated",
    "repair": "blind",
    "fault": "gain:scale=0.6",
    "library": "carts",
    "scenes": "40",
    "arguments": "--workers=0\n--no-signals\n",
}


@dataclass
class Job:
    """A job that runs the action in a folder of its own."""

    folder: Path
    inputs: dict[str, str]
    outputs: dict[str, dict[str, str]] = field(default_factory=dict)
    words: str = ""

    def value(self, expression: str) -> str:
        """Return what an expression of the action stands for."""
        match expression.split("."):
            case ["inputs", name]:
                return self.inputs.get(name, ACTION["inputs"][name].get("default", ""))
            case ["steps", step, "outputs", name]:
                return self.outputs[step].get(name, "")
        raise AssertionError(f"the runner of this test does not know {expression}")

    def run(self, step: dict) -> int:
        """Run a step in bash as a runner does, and return its exit status."""
        assert step["shell"] == "bash"
        (script := self.folder / "step.sh").write_text(step["run"], "utf-8")
        (written := self.folder / "output").write_text("")
        runner = {
            "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
            "GITHUB_ACTION_PATH": str(ROOT),
            "GITHUB_OUTPUT": str(written),
            "GITHUB_STEP_SUMMARY": str(self.folder / "step-summary.md"),
        }
        variables = {
            name: EXPRESSION.sub(lambda match: self.value(match[1]), text)
            for name, text in step["env"].items()
        }
        done = subprocess.run(
            ["bash", "--noprofile", "--norc", "-eo", "pipefail", script],
            cwd=self.folder,
            env=os.environ | runner | variables,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=300,
        )
        self.words += done.stdout
        lines = (line.split("=", 1) for line in written.read_text("utf-8").splitlines())
        self.outputs[step.get("id", "")] = dict(lines)
        return done.returncode

    def output(self, name: str) -> Path:
        """Return the file that an output of the action names."""
        text = ACTION["outputs"][name]["value"]
        return self.folder / EXPRESSION.sub(lambda match: self.value(match[1]), text)


def job(place: Path, **inputs: str) -> tuple[Job, int]:
    """Run the action after its installation; return the job and its exit status."""
    (place / "examples").symlink_to(ROOT / "examples")
    (place / "step-summary.md").write_text("Before.\n")
    named = {name.replace("_", "-"): text for name, text in inputs.items()}
    started = Job(place, TOY | named)
    status = next((status for step in STEPS if (status := started.run(step))), 0)
    return started, status


def test_no_input_is_part_of_a_script() -> None:
    assert not any(EXPRESSION.search(step["run"]) for step in (INSTALL, *STEPS))
    used = {match for step in (INSTALL, *STEPS) for match in EXPRESSION.findall(str(step["env"]))}
    assert {f"inputs.{name}" for name in ACTION["inputs"]} <= used


def test_the_workflow_of_the_page_uses_what_the_action_has() -> None:
    page = (ROOT / "docs" / "continuous-integration.md").read_text("utf-8")
    (text,) = re.findall(r"```yaml\n(name:.*?)```", page, re.DOTALL)
    steps = yaml.safe_load(text)["jobs"]["audit"]["steps"]
    (used,) = [step for step in steps if "/faultpath@" in step.get("uses", "")]
    required = {name for name, about in ACTION["inputs"].items() if about.get("required")}
    assert required <= set(used["with"]) <= set(ACTION["inputs"])
    assert used["with"]["fail-if"] == ACTION["inputs"]["fail-if"]["default"]
    assert set(re.findall(r"steps\.audit\.outputs\.(\w+)", text)) <= set(ACTION["outputs"])
    version = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    assert used["uses"] == f"OWNER/faultpath@v{version}"


def test_a_repair_that_loses_fails_the_job(tmp_path: Path) -> None:
    ended, status = job(tmp_path, fail_if="reversal, repair-behind")
    assert status == 1
    assert ended.value("steps.audit.outputs.status") == "1"
    assert "--fail-if reversal: Sharing the fault reverses the ranking" in ended.words
    summary = (tmp_path / "step-summary.md").read_text("utf-8")
    assert summary.startswith("Before.\n### Do not choose by the fault at the observer alone")
    marker, comment = ended.output("comment").read_text("utf-8").split("\n", 1)
    assert marker == "<!-- faultpath-audit -->"
    assert comment == ended.output("summary").read_text("utf-8")
    cases = ElementTree.parse(ended.output("junit")).getroot().iter("testcase")
    failed = {case.get("name") for case in cases if case.find("failure") is not None}
    assert failed == {"no-reversal", "no-repair-behind"}
    assert '"record"' in ended.output("record").read_text("utf-8")
    assert ended.output("report").read_text("utf-8").startswith("<!doctype html>")


def test_a_repair_that_does_not_lose_passes_and_sizes_have_one_page(tmp_path: Path) -> None:
    calm = {"fault": "gain:scale=0.98,1.02", "scenes": "6", "folder": "results/gain"}
    ended, status = job(tmp_path, **calm)
    assert status == 0, ended.words
    assert ended.output("report") == tmp_path / "results" / "gain" / "run" / "sweep.html"
    assert ended.output("comment").read_text("utf-8").count("### ") == 2
    assert len(list(ElementTree.parse(ended.output("junit")).getroot())) == 2


MISTAKES = {
    "no system": ({"system": ""}, "the input 'system' is empty"),
    "no variant": ({"baseline": "100 %"}, "toy: unknown variant '100 %'; known: blind, calibrated"),
    "odd folder": ({"folder": "a b"}, "the input 'folder' takes letters"),
}


@pytest.mark.parametrize("case", MISTAKES)
def test_a_mistake_ends_with_2_and_one_sentence(case: str, tmp_path: Path) -> None:
    inputs, sentence = MISTAKES[case]
    ended, status = job(tmp_path, **inputs)
    assert status == 2
    (annotation,) = re.findall(r"^::error::(.*)$", ended.words, re.MULTILINE)
    assert sentence in annotation.replace("%25", "%")
    lines = (tmp_path / "step-summary.md").read_text("utf-8").splitlines()
    assert lines[1:3] == ["### The audit did not run", ""]
    assert lines[3:] == [f"    {annotation.replace('%25', '%')}"]
    assert ended.output("comment").is_file()
    assert ended.value("steps.audit.outputs.junit") == ""


HOSTILE = "$(touch caught) `touch caught`; touch caught #\" ' *"


@pytest.mark.parametrize("kept", [(), ("system", "folder", "fail_if")])
def test_no_input_is_run(kept: tuple[str, ...], tmp_path: Path) -> None:
    names = [name for name in ACTION["inputs"] if name.replace("-", "_") not in kept]
    ended, status = job(tmp_path, **dict.fromkeys(names, HOSTILE))
    (command := tmp_path / "python").write_text('#!/bin/sh\nprintf "%s\\n" "$@" >called\n')
    command.chmod(0o755)
    ended.run(INSTALL | {"run": f'PATH="{tmp_path}:$PATH"\n{INSTALL["run"]}'})
    assert status == 2
    assert not list(tmp_path.rglob("caught"))
    assert (tmp_path / "called").read_text().splitlines()[-1] == f"{ROOT}[{HOSTILE}]"


def test_it_installs_the_checkout_that_it_is_in(tmp_path: Path) -> None:
    """From what is here alone: no index, no dependency."""
    options = (
        "PIP_NO_INDEX=1 PIP_NO_DEPS=1 PIP_NO_BUILD_ISOLATION=0 PIP_DISABLE_PIP_VERSION_CHECK=1"
    )
    target = f"export {options} PIP_TARGET={tmp_path / 'target'}\n"
    started = Job(tmp_path, TOY)
    assert started.run(INSTALL | {"run": target + INSTALL["run"]}) == 0, started.words
    assert (tmp_path / "target" / "faultpath" / "__main__.py").is_file()
