"""Declarations of the packages agree with each other, with imports, and with the release."""

import ast
import importlib.metadata
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import packages_distributions
from itertools import chain
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import faultpath
from faultpath.run.registry import _EXTRAS

ROOT = Path(__file__).resolve().parents[2]
OWN = {"faultpath", "faultpath_quadrotor", "faultpath_paper"}
# Packages whose types are part of the interface of the one that brings them.
BROUGHT_BY = {"pydantic-core": "pydantic", "markupsafe": "jinja2", "click": "typer"}
TABLES: dict[str, Any] = {
    folder: tomllib.loads((ROOT / folder / "pyproject.toml").read_text("utf-8"))
    for folder in (".", "quadrotor", "paper")
}
PROJECTS: dict[str, Any] = {folder: table["project"] for folder, table in TABLES.items()}
ENGINE = PROJECTS["."]
EXTRAS: dict[str, list[str]] = ENGINE["optional-dependencies"]
PINS = [
    Requirement(line)
    for line in (ROOT / "constraints.txt").read_text("utf-8").splitlines()
    if line and not line.startswith("#")
]
WORKFLOW = (ROOT / ".github" / "workflows" / "release.yml").read_text("utf-8")
JOBS = yaml.safe_load(WORKFLOW)["jobs"]


def test_all_packages_have_one_version_and_ask_for_each_other_in_it() -> None:
    (version,) = {project["version"] for project in PROJECTS.values()}
    assert faultpath.__version__ == version
    for name in OWN - {"faultpath_paper"}:
        assert importlib.metadata.version(name) == version
    lines = [line for project in PROJECTS.values() for line in project["dependencies"]]
    ours = [line for line in lines if line.startswith("faultpath")]
    assert len(ours) == 3
    assert all(line.endswith(f"=={version}") for line in ours)


def test_constraints_pin_one_public_version_each() -> None:
    names = [canonicalize_name(pin.name) for pin in PINS]
    assert names == sorted(names)
    assert len({(pin.name, str(pin.marker)) for pin in PINS}) == len(PINS)
    for pin in PINS:
        (specifier,) = pin.specifier
        assert specifier.operator == "=="
        assert "+" not in specifier.version


def test_constraints_satisfy_every_declared_range() -> None:
    versions = {canonicalize_name(pin.name): next(iter(pin.specifier)).version for pin in PINS}
    for line in chain(ENGINE["dependencies"], *EXTRAS.values()):
        requirement = Requirement(line)
        name = canonicalize_name(requirement.name)
        if name != "faultpath":
            assert requirement.specifier.contains(versions[name]), requirement


def test_what_is_to_be_installed_exists() -> None:
    named: set[str] = set()
    pages = (*(ROOT / "src").rglob("*.py"), *(ROOT / "docs").glob("*.md"), ROOT / "README.md")
    for file in pages:
        text = file.read_text("utf-8")
        assert not re.search(r"pip install '?faultpath", text), file
        pairs = re.findall(r"pip install '(?:\.|/faultpath)\[([\w,]+)\]'|\bextra\(['\"](\w+)", text)
        named |= {name for names in chain(*pairs) for name in names.split(",") if name}
    assert {"torch", "ray"} <= named
    assert named <= set(EXTRAS)
    assert {"torch", "gymnasium"} <= set(_EXTRAS) <= set(EXTRAS)


def test_the_readme_names_the_paper_that_is_to_be_cited() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    assert (citation["title"], citation["version"]) == (ENGINE["name"], ENGINE["version"])
    assert citation["license"] == ENGINE["license"]
    paper = citation["preferred-citation"]
    (number,) = (item["value"].removeprefix("arXiv:") for item in paper["identifiers"])
    readme = (ROOT / "README.md").read_text("utf-8")
    assert f"*{paper['title']}*" in readme
    assert f"arXiv {number}" in readme


def imported(source: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            yield node.module.partition(".")[0]


def third_party(folder: str) -> set[str]:
    """Return the packages of others that the sources of a distribution import."""
    files = sorted((ROOT / folder / "src").rglob("*.py"))
    names = {name for path in files for name in imported(path.read_text("utf-8"))}
    distributions, needed = packages_distributions(), set[str]()
    for name in names - sys.stdlib_module_names - OWN:
        bringing = {canonicalize_name(other) for other in distributions.get(name, [name])}
        needed.add(name if name in bringing else min(bringing))  # several share `mujoco`
    return {BROUGHT_BY.get(name, name) for name in needed}


def declared(folder: str, *extras: str) -> set[str]:
    project = PROJECTS[folder]
    lines = chain(project["dependencies"], *(project["optional-dependencies"][e] for e in extras))
    names = {canonicalize_name(Requirement(line).name) for line in lines}
    return names - {canonicalize_name(name) for name in OWN}


def test_the_engine_imports_what_is_declared_and_nothing_else() -> None:
    assert third_party(".") == declared(".", "gymnasium", "torch", "ray", "pytest")


@pytest.mark.parametrize("folder", ["quadrotor", "paper"])
def test_what_is_built_on_the_engine_imports_only_what_is_declared(folder: str) -> None:
    assert third_party(folder) <= declared(".") | declared("quadrotor")


def test_every_dependency_has_its_line_in_the_design_notes() -> None:
    notes = (ROOT / "docs" / "design" / "dependencies.md").read_text("utf-8").lower()
    names = declared(".", "dev", "test") | declared("quadrotor", "mujoco")
    assert {name for name in names if name not in notes} == set()


def test_only_a_tag_is_published_and_only_after_the_checks_and_no_secret_is_stored() -> None:
    publish = JOBS["publish"]
    assert publish["if"] == "github.ref_type == 'tag'"
    assert set(publish["needs"]) == set(JOBS) - {"build", "publish"}
    assert all(JOBS[check]["needs"] == "build" for check in publish["needs"])
    assert publish["permissions"] == {"id-token": "write"}
    assert "secrets." not in WORKFLOW


def test_every_script_of_the_release_is_bash_and_every_wheel_is_built_and_compared() -> None:
    scripts = [step["run"] for job in JOBS.values() for step in job["steps"] if "run" in step]
    for script in scripts:
        subprocess.run(["bash", "-n", "-c", script], check=True)
    (compared,) = re.findall(r"for name in (.*); do", WORKFLOW)
    assert set(compared.split()) == OWN
    built = " ".join(re.findall(r"--wheel-dir dist (.*)|cibuildwheel\S* (\S+)", WORKFLOW)[0])
    assert {".", "./paper"} <= set(built.split())
    assert "cibuildwheel" in TABLES["quadrotor"]["tool"]


def test_the_release_checks_the_engine_under_each_python_that_it_names() -> None:
    named = [c.rpartition(" ")[2] for c in ENGINE["classifiers"] if "Python :: 3." in c]
    assert JOBS["engine"]["strategy"]["matrix"]["python"] == named
