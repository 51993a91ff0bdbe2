"""Imports: what loads what, and what may; the core works without torch."""

import ast
import json
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from subprocess import CompletedProcess
from textwrap import dedent

import grimp

Run = Callable[..., CompletedProcess[str]]

ROOMS = ("loop", "faults", "interface", "system", "learning")
PUBLIC = {"faultpath", *(f"faultpath.{room}" for room in ROOMS)}
"""With the modules of `faultpath.plugin`, where a package may take names of the engine from."""


def test_no_module_of_the_engine_loads_torch_when_imported(run: Run) -> None:
    code = """
    import importlib, json, sys
    for name in json.loads(sys.argv[1]):
        importlib.import_module(name)
        assert "torch" not in sys.modules, f"{name} loads torch"
    """
    done = run("-c", dedent(code), json.dumps(sorted(grimp.build_graph("faultpath").modules)))
    assert done.returncode == 0, done.stderr


def test_no_modules_import_each_other_in_a_circle() -> None:
    graph = grimp.build_graph("faultpath", "faultpath_quadrotor")
    left = {
        module: set(graph.find_modules_directly_imported_by(module)) for module in graph.modules
    }
    while free := {m for m, needed in left.items() if not needed & left.keys()}:
        for module in free:
            del left[module]
    assert not left, f"these import each other, or depend on some that do: {sorted(left)}"


def test_the_quadrotor_takes_only_names_that_the_engine_lists(root: Path) -> None:
    names: list[tuple[str, str]] = []
    for path in (root / "quadrotor/src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                names += [(alias.name, "") for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                names += [(node.module or "", alias.name) for alias in node.names]
    engine = {pair for pair in names if pair[0].partition(".")[0] == "faultpath"}
    public = {module for module, _ in engine if module.startswith("faultpath.plugin.")} | PUBLIC
    private = [
        f"{module}.{name}".rstrip(".")
        for module, name in sorted(engine)
        if module not in public or name not in import_module(module).__all__
    ]
    assert engine
    assert not private
