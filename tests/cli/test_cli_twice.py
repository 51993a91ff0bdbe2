"""An option that takes one value is given once: of two, one would be dropped without a word."""

import subprocess

import pytest
from cli_runs import ROOT, audit


@pytest.mark.parametrize("again", [["--library", "carts"], ["--library=carts"]])
def test_so_is_the_same_value_in_either_form(again, tmp_path):
    said = audit(*again, out=tmp_path / "run").refused()
    assert "--library is given twice: give it once" in said
    assert list(tmp_path.iterdir()) == []


def test_an_option_that_takes_several_may_be_given_several_times(tmp_path):
    said = audit("--set", "a=1", "--set", "b=2", out=tmp_path / "run").refused()
    assert "the options of system" in said  # the toy has neither


@pytest.mark.parametrize("given", ["--wind L0 --seeds 0,1", "--wind=L0", "--scenes 20"])
def test_make_audit_gives_what_its_user_does_not(given):
    made = ["make", "--no-print-directory", "--dry-run", "--always-make", "audit", f"ARGS={given}"]
    shown = subprocess.run(made, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    words = shown.replace("\\\n", " ").partition("faultpath audit quadrotor ")[2].split()
    assert " ".join(words).endswith(given)
    options = [word.partition("=")[0] for word in words if word.startswith("--")]
    assert sorted(options) == sorted(set(options))
    assert {"--baseline", "--repair", "--fault", "--library", "--wind"} <= set(options)


def test_make_audit_runs_the_command_that_the_page_gives():
    made = ["make", "--no-print-directory", "--dry-run", "--always-make", "audit"]
    shown = subprocess.run(made, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    lines = [" ".join(line.split()) for line in shown.replace("\\\n", " ").splitlines()]
    (line,) = [line for line in lines if "faultpath audit quadrotor" in line]
    page = " ".join((ROOT / "docs" / "quadrotor.md").read_text().replace("\\\n", " ").split())
    assert f"$ {line.removeprefix('.venv/bin/')} ```" in page
