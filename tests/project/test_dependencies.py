"""What the core imports is what the package declares, no less and no more."""

import ast
import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

OWN = {"faultpath", "faultpath_quadrotor", "faultpath_paper"}
# Packages whose types are part of the interface of the one that brings them.
BROUGHT_BY = {"pydantic-core": "pydantic", "markupsafe": "jinja2", "click": "typer"}


def _imported(source: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            yield node.module.partition(".")[0]


def _third_party(files: list[Path]) -> set[str]:
    names = {name for path in files for name in _imported(path.read_text(encoding="utf-8"))}
    distributions = packages_distributions()
    outside = names - sys.stdlib_module_names - OWN
    found: set[str] = set()
    for name in outside:
        bringing = {canonicalize_name(each) for each in distributions.get(name, [name])}
        found.add(name if name in bringing else min(bringing))  # several share `mujoco`
    return {BROUGHT_BY.get(name, name) for name in found}


def _declared(project: Path, *extras: str) -> set[str]:
    declared = tomllib.loads((project / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = list(declared["dependencies"])
    for extra in extras:
        lines += declared["optional-dependencies"][extra]
    own = {name.replace("_", "-") for name in OWN}
    return {canonicalize_name(Requirement(line).name) for line in lines} - own


def _files(folder: Path) -> list[Path]:
    return sorted((folder / "src").rglob("*.py"))


def test_the_engine_imports_what_is_declared_and_nothing_else(root: Path) -> None:
    extras = ("gymnasium", "torch", "ray", "pytest")
    assert _third_party(_files(root)) == _declared(root, *extras)


@pytest.mark.parametrize("name", ["quadrotor", "paper"])
def test_what_is_built_on_the_engine_imports_only_what_is_declared(name: str, root: Path) -> None:
    declared = _declared(root) | _declared(root / "quadrotor")
    assert _third_party(_files(root / name)) <= declared


def test_every_dependency_has_its_line_in_the_design_notes(root: Path) -> None:
    notes = (root / "docs" / "design" / "dependencies.md").read_text(encoding="utf-8").lower()
    declared = _declared(root, "dev", "test")
    declared |= _declared(root / "quadrotor", "mujoco")
    assert {name for name in declared if name not in notes} == set()
