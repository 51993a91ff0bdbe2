"""What a Python file imports, read from its source without running it, and its digest."""

import ast
import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from types import ModuleType
from weakref import WeakKeyDictionary


@dataclass(frozen=True)
class Import:
    """One statement, or one call that imports a name that stands there."""

    module: str
    """Dotted name; empty in `from . import x`."""
    names: tuple[tuple[str, str], ...] = ()
    """What is taken from the module, each with the name that it gets here; empty in `import a`."""
    level: int = 0
    """Leading dots."""


@dataclass(frozen=True)
class Imports:
    """What a file imports, wherever the statement stands: also inside functions."""

    imports: tuple[Import, ...] = ()
    computed: bool = False
    """Whether it also imports by a name that is known only when it runs."""
    facade: bool = False
    """Whether the file does nothing but import and list what it exports."""


_BY_NAME = frozenset({"import_module", "__import__"})
_BY_PATH = frozenset(
    {
        "spec_from_file_location",
        "run_path",
        "run_module",
        "SourceFileLoader",
        "SourcelessFileLoader",
        "ExtensionFileLoader",
        "exec_module",
        "walk_packages",
        "iter_modules",
    }
)


def imports_of(source: bytes) -> Imports:
    """Return what a source file imports; nothing for one that Python cannot read.

    Statements under `if TYPE_CHECKING:` are left out, because they never run.
    """
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError, RecursionError):
        return Imports()
    found = [each for node in _statements(tree.body) for each in _imported(node)]
    computed = False
    if any(word.encode() in source for word in _BY_NAME | _BY_PATH):
        calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
        named = [_literal(call) for call in calls if _called(call) in _BY_NAME]
        found += [each for each in named if each is not None]
        computed = None in named or any(_called(call) in _BY_PATH for call in calls)
    return Imports(tuple(found), computed, all(map(_exports, tree.body)))


def _statements(body: Sequence[ast.AST]) -> Iterator[ast.AST]:
    waiting = list(body)
    while waiting:
        node = waiting.pop()
        yield node
        if isinstance(node, ast.If) and _never_runs(node.test):
            waiting += node.orelse
            continue
        for inner in ("body", "orelse", "finalbody", "handlers", "cases"):
            children = getattr(node, inner, ())
            if isinstance(children, list):
                waiting += children


def _imported(node: ast.AST) -> Iterator[Import]:
    if isinstance(node, ast.Import):
        for alias in node.names:
            yield Import(alias.name)
    elif isinstance(node, ast.ImportFrom):
        names = tuple((alias.name, alias.asname or alias.name) for alias in node.names)
        yield Import(node.module or "", names, node.level)


def _never_runs(test: ast.expr) -> bool:
    name = test.attr if isinstance(test, ast.Attribute) else getattr(test, "id", "")
    return name == "TYPE_CHECKING"


def _called(call: ast.Call) -> str:
    function = call.func
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def _literal(call: ast.Call) -> Import | None:
    first = call.args[0] if call.args else None
    if not isinstance(first, ast.Constant) or not isinstance(first.value, str):
        return None
    name = first.value.lstrip(".")
    return Import(name, level=len(first.value) - len(name))


def _exports(node: ast.stmt) -> bool:
    if isinstance(node, ast.Import | ast.ImportFrom):
        return True
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Constant)  # the docstring
    targets = node.targets if isinstance(node, ast.Assign) else []
    return [getattr(target, "id", "") for target in targets] == ["__all__"]


@dataclass(frozen=True)
class Contents:
    """A file's digest and what it imports."""

    sha256: str
    imports: Imports


_read: dict[str, Contents] = {}
"""By digest: a file is taken apart once."""
_loaded: WeakKeyDictionary[ModuleType, Contents] = WeakKeyDictionary()
"""What a module was when it was first asked for: later edits do not reach what is loaded."""


def contents(name: str, path: Path) -> Contents:
    """Return the contents of module `name`, in `path`.

    Of a module that this process has imported they stay what they were at the first call, because
    what runs here does not change with the file. `OSError` when the file cannot be read.
    """
    module = sys.modules.get(name)
    if module is None or not _is_file(module, path):
        return _contents(path)
    if module not in _loaded:
        _loaded[module] = _contents(path)
    return _loaded[module]


def _contents(path: Path) -> Contents:
    data = path.read_bytes()
    digest = sha256(data).hexdigest()
    if digest not in _read:
        imports = imports_of(data) if path.suffix == ".py" else Imports()
        _read[digest] = Contents(digest, imports)
    return _read[digest]


def _is_file(module: ModuleType, path: Path) -> bool:
    file = getattr(module, "__file__", None)
    return file is not None and os.path.realpath(file) == os.path.realpath(path)
