"""The package's declarations agree with each other."""

import importlib.metadata
import re
import tomllib
from itertools import chain
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import faultpath
from faultpath.run.registry import _EXTRAS


@pytest.fixture(scope="module")
def declared(root: Path) -> dict[str, Any]:
    return tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def pins(root: Path) -> list[Requirement]:
    lines = (root / "constraints.txt").read_text(encoding="utf-8").splitlines()
    return [Requirement(line) for line in lines if line and not line.startswith("#")]


def test_version_is_the_same_everywhere(declared: dict[str, Any], root: Path) -> None:
    version = declared["project"]["version"]
    assert faultpath.__version__ == version
    assert importlib.metadata.version("faultpath") == version
    assert importlib.metadata.version("faultpath-quadrotor") == version
    quadrotor = tomllib.loads((root / "quadrotor" / "pyproject.toml").read_text("utf-8"))
    assert f"faultpath=={version}" in quadrotor["project"]["dependencies"]


def test_constraints_pin_one_public_version_each(pins: list[Requirement]) -> None:
    names = [canonicalize_name(pin.name) for pin in pins]
    assert names == sorted(names)
    assert len({(pin.name, str(pin.marker)) for pin in pins}) == len(pins)
    for pin in pins:
        (specifier,) = pin.specifier
        assert specifier.operator == "=="
        assert "+" not in specifier.version


def test_constraints_satisfy_every_declared_range(
    declared: dict[str, Any], pins: list[Requirement]
) -> None:
    versions = {canonicalize_name(pin.name): next(iter(pin.specifier)).version for pin in pins}
    project = declared["project"]
    extras = project["optional-dependencies"].values()
    lines = [*project["dependencies"], *chain.from_iterable(extras)]
    for requirement in map(Requirement, lines):
        name = canonicalize_name(requirement.name)
        if name != "faultpath":
            assert requirement.specifier.contains(versions[name]), requirement


def test_what_is_to_be_installed_exists(declared: dict[str, Any], root: Path) -> None:
    extras = set(declared["project"]["optional-dependencies"])
    named: set[str] = set()
    for file in (*(root / "src").rglob("*.py"), *(root / "docs").glob("*.md"), root / "README.md"):
        text = file.read_text("utf-8")
        assert not re.search(r"pip install '?faultpath", text), file
        found = re.findall(r"pip install '(?:\.|/faultpath)\[([\w,]+)\]'|\bextra\(['\"](\w+)", text)
        named |= {each for pair in found for one in pair for each in one.split(",") if each}
    assert {"torch", "ray"} <= named
    assert named <= extras
    assert {"torch", "gymnasium"} <= set(_EXTRAS) <= extras


def test_the_readme_names_the_paper_that_is_to_be_cited(
    declared: dict[str, Any], root: Path
) -> None:
    cited = yaml.safe_load((root / "CITATION.cff").read_text("utf-8"))
    project = declared["project"]
    assert (cited["title"], cited["version"]) == (project["name"], project["version"])
    assert cited["license"] == project["license"]
    paper = cited["preferred-citation"]
    (number,) = (item["value"].removeprefix("arXiv:") for item in paper["identifiers"])
    readme = (root / "README.md").read_text("utf-8")
    assert f"*{paper['title']}*" in readme
    assert f"arXiv {number}" in readme
