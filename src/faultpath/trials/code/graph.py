"""From a module to every file that it may run, by following imports without running anything."""

import ast
import os
import sys
import sysconfig
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib.machinery import ModuleSpec
from importlib.metadata import PackageNotFoundError, distribution, packages_distributions
from pathlib import Path
from types import ModuleType
from typing import Literal
from weakref import WeakKeyDictionary

from faultpath.core.error_source import ours

_COMPUTED = tuple(
    word.encode()
    for word in (
        *("import_module", "__import__", "spec_from_file_location", "SourceFileLoader"),
        *("exec_module", "run_path", "run_module", "walk_packages", "iter_modules"),
    )
)
"""What imports, in a source, by a name or path that may be known only when it runs."""
_INSTALLED = frozenset({"site-packages", "dist-packages"})
_NO_SOURCE = frozenset({"__pycache__", "node_modules"})


Kind = Literal["standard", "installed", "local"]
"""Whose a file is: part of Python, of an installed package, or the user's own."""


@dataclass(frozen=True)
class Root:
    """A module to start from: its name, and its file where it cannot be found by its name."""

    module: str
    file: Path | None = None
    of_system: bool = True
    """Whether its package belongs to the system, so that it is entered even where installed."""

    @property
    def path(self) -> Path | None:
        """The module's file, if there is one."""
        return self.file or file_of(locate(self.module))


@dataclass(frozen=True)
class Contents:
    """A file's digest and what it imports."""

    sha256: str
    imports: tuple[tuple[str, int, tuple[str, ...]], ...] = ()
    """Module, leading dots, and names taken from it, of each import anywhere in the file."""
    computed: bool = False
    """Whether it may also import by a name that is known only when it runs."""


class Graph:
    """The files and installed packages that some modules reach.

    Files count wherever an import of them stands, so that one inside a function counts before it
    runs. A module that imports by a computed name may load whatever lies beside and below it:
    all of that counts. Installed packages are not entered, except those that hold a root.
    """

    def __init__(self) -> None:
        self.files: dict[str, tuple[Path, str]] = {}
        """By name: the file and the digest of its contents."""
        self.packages: dict[str, str] = {}
        """Versions of what is installed, by top-level package."""
        self._entered: set[str] = set()
        self.seen: set[str] = set()
        """Names of all modules that were asked for, whether they are there or not."""
        self._paths: set[Path] = set()

    def add(self, root: Root) -> None:
        """Follow everything that a root imports."""
        if root.of_system:
            self._entered.add(root.module.partition(".")[0])
        if root.file is None:
            self._module(root.module)
        else:
            self._file(root.file, root.file.name, "", root.module)

    def _module(self, name: str) -> None:
        """Take in the packages that a module lies in, as an import does, and the module."""
        parts = name.split(".")
        for each in (".".join(parts[:end]) for end in range(1, len(parts) + 1)):
            if each in self.seen or (ours(each) and "." not in each):  # front doors decide nothing
                continue
            self.seen.add(each)
            spec = locate(each)
            path = file_of(spec)
            if spec is None or path is None:
                continue
            if not ours(each):
                kind = kind_of(path)
                if kind == "standard":
                    continue
                if kind == "installed" and parts[0] not in self._entered:
                    version = self.packages.get(parts[0]) or release(parts[0])
                    if version is not None:
                        self.packages[parts[0]] = version
                        continue
            stem = each.replace(".", "/")
            label = f"{stem}/{path.name}" if path.stem == "__init__" else f"{stem}{path.suffix}"
            folder = spec.submodule_search_locations is not None
            self._file(path, label, each if folder else each.rpartition(".")[0], each)

    def _file(self, path: Path, label: str, package: str, name: str) -> None:
        path = Path(os.path.realpath(path))
        if path in self._paths:
            return
        self._paths.add(path)
        found = contents(name, path)
        if label in self.files:
            label = f"{path.parent.name}/{label}"
        self.files[label] = (path, found.sha256)
        for module, level, names in found.imports:
            if base := _absolute(module, level, package):
                self._module(base)
                for each in names:
                    self._module(f"{base}.{each}")
        if found.computed and not ours(name):
            for beside in _sources(path.parent):
                parts = beside.relative_to(path.parent).with_suffix("").parts
                inside = ".".join(part for part in (package, *parts[:-1]) if part)
                below = beside.relative_to(path.parent.parent).as_posix()
                self._file(beside, below, inside, ".".join((package, *parts)).strip("."))


def _absolute(module: str, level: int, package: str) -> str:
    if not level:
        return module
    parts = package.split(".")
    if not package or level > len(parts):
        return "" if package else module  # a file of its own has no package to look in
    return ".".join((*parts[: len(parts) - level + 1], *filter(None, (module,))))


def _sources(folder: Path) -> Iterator[Path]:
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(
            each
            for each in folders
            if not each.startswith(".")
            and each not in _NO_SOURCE
            and not (Path(place) / each / "pyvenv.cfg").exists()
        )
        yield from (Path(place) / each for each in sorted(files) if each.endswith(".py"))


def locate(name: str) -> ModuleSpec | None:
    """Return where a module comes from, `None` for one that is not there.

    One that this process has imported comes from where it was found; any other is looked for as
    an import would, except that no package is run on the way.
    """
    loaded = getattr(sys.modules.get(name), "__spec__", None)
    if loaded is not None:
        return loaded
    parent, _, last = name.rpartition(".")
    path = None
    if parent:
        package = locate(parent)
        if package is None or package.submodule_search_locations is None:
            return None
        path = list(package.submodule_search_locations)
    for finder in sys.meta_path:
        try:
            spec = finder.find_spec(name, path)
        except (ImportError, AttributeError, ValueError):
            continue
        except KeyError:  # a folder without `__init__.py` whose parent is not imported
            spec = ModuleSpec(name, None, is_package=True)
            spec.submodule_search_locations = [os.path.join(each, last) for each in path or ()]
        if spec is not None:
            return spec
    return None


def file_of(spec: ModuleSpec | None) -> Path | None:
    """Return the file of a module, `None` for a built-in one or a package without a file."""
    if spec is None or not spec.has_location or spec.origin is None:
        return None
    return Path(spec.origin)


@cache
def _folders(*names: str) -> tuple[str, ...]:
    paths = (sysconfig.get_path(name) for name in names)
    return tuple(dict.fromkeys(os.path.realpath(path) + os.sep for path in paths if path))


@cache
def kind_of(path: Path) -> Kind:
    """Return whose a file is, by where it lies."""
    folder = path.parent
    real = os.path.realpath(folder) + os.sep
    if not _INSTALLED.isdisjoint(folder.parts) or real.startswith(_folders("purelib", "platlib")):
        return "installed"
    return "standard" if real.startswith(_folders("stdlib", "platstdlib")) else "local"


@cache
def release(package: str) -> str | None:
    """Return the version of the distribution that holds a top-level package, `None` without one.

    One that was installed from a folder or an archive of the user's own keeps its version while
    its contents change; a digest of what was installed stands beside it.
    """
    if package in sys.stdlib_module_names:  # no distribution has them, and looking takes seconds
        return None
    try:
        found = distribution(package)
    except (PackageNotFoundError, ValueError):
        names = packages_distributions().get(package)
        if not names:
            return None
        found = distribution(names[0])
    if found.read_text("direct_url.json") is None:
        return found.version
    lines = (found.read_text("RECORD") or "").splitlines()
    held = sorted(line for line in lines if "sha256=" in line and "dist-info" not in line)
    return f"{found.version} ({sha256(repr(held).encode()).hexdigest()[:16]})"


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
    file = getattr(module, "__file__", None)
    mine = module if file and os.path.realpath(file) == os.path.realpath(path) else None
    if mine is not None and mine in _loaded:
        return _loaded[mine]
    data = path.read_bytes()
    digest = sha256(data).hexdigest()
    if digest not in _read:
        _read[digest] = _taken_apart(data, digest) if path.suffix == ".py" else Contents(digest)
    if mine is not None:
        _loaded[mine] = _read[digest]
    return _read[digest]


def _taken_apart(source: bytes, digest: str) -> Contents:
    """Read imports off a source file; it has none where Python cannot read it."""
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError, RecursionError):
        return Contents(digest)
    found: list[tuple[str, int, tuple[str, ...]]] = []
    waiting: list[ast.AST] = list(tree.body)
    while waiting:  # statements alone: imports stand in no expression
        node = waiting.pop()
        if isinstance(node, ast.Import):
            found += [(alias.name, 0, ()) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = tuple(alias.name for alias in node.names if alias.name != "*")
            found.append((node.module or "", node.level, names))
        test = getattr(node, "test", None)
        typed = "TYPE_CHECKING" in (getattr(test, "attr", ""), getattr(test, "id", ""))
        for inner in ("body", "orelse", "finalbody", "handlers", "cases"):
            children = () if typed and inner == "body" else getattr(node, inner, ())
            waiting += children if isinstance(children, list) else ()
    return Contents(digest, tuple(found), any(word in source for word in _COMPUTED))
