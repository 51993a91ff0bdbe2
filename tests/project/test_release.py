"""The release workflow: it publishes what was checked, from a tag alone, and stores no secret."""

import re
import subprocess
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / ".github" / "workflows" / "release.yml").read_text("utf-8")
JOBS = yaml.safe_load(TEXT)["jobs"]
PROJECTS = {
    folder: tomllib.loads((ROOT / folder / "pyproject.toml").read_text("utf-8"))
    for folder in (".", "quadrotor", "paper")
}


def test_only_a_tag_is_published_and_only_after_the_checks() -> None:
    publish = JOBS["publish"]
    assert publish["if"] == "github.ref_type == 'tag'"
    assert set(publish["needs"]) == set(JOBS) - {"build", "publish"}
    assert all(JOBS[check]["needs"] == "build" for check in publish["needs"])
    assert publish["permissions"] == {"id-token": "write"}
    assert "secrets." not in TEXT


def test_every_script_is_bash_and_every_wheel_is_built_and_compared() -> None:
    scripts = [step["run"] for job in JOBS.values() for step in job["steps"] if "run" in step]
    for script in scripts:
        subprocess.run(["bash", "-n", "-c", script], check=True)
    names = {project["project"]["name"].replace("-", "_") for project in PROJECTS.values()}
    (compared,) = re.findall(r"for name in (.*); do", TEXT)
    assert set(compared.split()) == names
    built = " ".join(re.findall(r"--wheel-dir dist (.*)|cibuildwheel\S* (\S+)", TEXT)[0])
    assert {".", "./paper"} <= set(built.split())
    assert "cibuildwheel" in PROJECTS["quadrotor"]["tool"]


def test_the_engine_is_checked_under_each_python_that_it_names() -> None:
    classifiers = PROJECTS["."]["project"]["classifiers"]
    named = [name.rpartition(" ")[2] for name in classifiers if "Python :: 3." in name]
    assert JOBS["engine"]["strategy"]["matrix"]["python"] == named


def test_the_three_versions_are_one() -> None:
    (version,) = {project["project"]["version"] for project in PROJECTS.values()}
    required = [
        line for project in PROJECTS.values() for line in project["project"]["dependencies"]
    ]
    ours = [line for line in required if line.startswith("faultpath")]
    assert len(ours) == 3
    assert all(line.endswith(f"=={version}") for line in ours)
