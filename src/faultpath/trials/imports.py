"""From a module to every file that it may run, by following imports without running anything."""

import ast
import os
import sys
import sysconfig
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib.machinery import ModuleSpec
from importlib.metadata import PackageNotFoundError, distribution, packages_distributions, version
from importlib.util import resolve_name
from pathlib import Path
from types import ModuleType
from typing import Literal
from weakref import WeakKeyDictionary

from faultpath.core.error_source import ours

_COMPUTED = (
    *(b"import_module", b"__import__", b"spec_from_file_location", b"SourceFileLoader"),
    *(b"exec_module", b"run_path", b"run_module", b"walk_packages", b"iter_modules"),
)
"""Words in a source that import by a name or path which may be known only when it runs."""
_INSTALLED = frozenset({"site-packages", "dist-packages"})
_PACKAGES = ("numpy", "scipy", "pydantic", "pyarrow", "array-api-compat", "torch", "mujoco")
_NO_SOURCE = frozenset({"__pycache__", "node_modules"})


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


class ImportGraph:
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
        self.seen: set[str] = set()
        """Names of all modules that were asked for, whether they are there or not."""
        self._entered: set[str] = set()
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
        for module in (".".join(parts[:end]) for end in range(1, len(parts) + 1)):
            # Front doors decide nothing.
            if module in self.seen or (ours(module) and "." not in module):
                continue
            self.seen.add(module)
            spec = locate(module)
            path = file_of(spec)
            if spec is None or path is None:
                continue
            kind = "local" if ours(module) else kind_of(path)
            if kind == "standard":
                continue
            if kind == "installed" and parts[0] not in self._entered:
                version = self.packages.get(parts[0]) or release(parts[0])
                if version is not None:
                    self.packages[parts[0]] = version
                    continue
            stem = module.replace(".", "/")
            label = f"{stem}/{path.name}" if path.stem == "__init__" else f"{stem}{path.suffix}"
            folder = spec.submodule_search_locations is not None
            self._file(path, label, module if folder else module.rpartition(".")[0], module)

    def _file(self, path: Path, label: str, package: str, name: str) -> None:
        path = Path(os.path.realpath(path))
        if path in self._paths:
            return
        self._paths.add(path)
        contents = _contents(name, path)
        if label in self.files:
            label = f"{path.parent.name}/{label}"
        self.files[label] = (path, contents.sha256)
        for module, names in contents.imports:
            try:
                base = resolve_name(module, package)
            except ImportError:  # a file of its own has no package to look in
                continue
            self._module(base)
            for member in names:
                self._module(f"{base}.{member}")
        if not contents.computed or ours(name):
            return
        for place, folders, files in os.walk(path.parent):
            folders[:] = sorted(
                folder
                for folder in folders
                if not folder.startswith(".")
                and folder not in _NO_SOURCE
                and not os.path.exists(os.path.join(place, folder, "pyvenv.cfg"))
            )
            for beside in (Path(place, file) for file in sorted(files) if file.endswith(".py")):
                parts = beside.relative_to(path.parent).with_suffix("").parts
                inside = ".".join(part for part in (package, *parts[:-1]) if part)
                below = beside.relative_to(path.parent.parent).as_posix()
                self._file(beside, below, inside, ".".join((package, *parts)).strip("."))


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
            spec.submodule_search_locations = [os.path.join(folder, last) for folder in path or ()]
        if spec is not None:
            return spec
    return None


def file_of(spec: ModuleSpec | None) -> Path | None:
    """Return the file of a module, `None` for a built-in one or a package without a file."""
    if spec is None or not spec.has_location or spec.origin is None:
        return None
    return Path(spec.origin)


@cache
def kind_of(path: Path) -> Literal["standard", "installed", "local"]:
    """Return whose a file is, by where it lies: Python's, an installed package's, the user's."""
    real = os.path.realpath(path.parent) + os.sep

    def lies_in(*names: str) -> bool:
        folders = filter(None, map(sysconfig.get_path, names))
        return real.startswith(tuple(os.path.realpath(folder) + os.sep for folder in folders))

    if not _INSTALLED.isdisjoint(path.parent.parts) or lies_in("purelib", "platlib"):
        return "installed"
    return "standard" if lies_in("stdlib", "platstdlib") else "local"


@cache
def release(package: str) -> str | None:
    """Return the version of the distribution that holds a top-level package, `None` without one.

    One that was installed from a folder or an archive of the user's own keeps its version while
    its contents change; a digest of what was installed stands beside it.
    """
    if package in sys.stdlib_module_names:  # no distribution has them, and looking takes seconds
        return None
    try:
        holder = distribution(package)
    except (PackageNotFoundError, ValueError):
        names = packages_distributions().get(package)
        if not names:
            return None
        holder = distribution(names[0])
    if holder.read_text("direct_url.json") is None:
        return holder.version
    lines = (holder.read_text("RECORD") or "").splitlines()
    records = sorted(line for line in lines if "sha256=" in line and "dist-info" not in line)
    return f"{holder.version} ({sha256(repr(records).encode()).hexdigest()[:16]})"


def packages() -> dict[str, str]:
    """Return the versions of the packages that numbers depend on, of those installed."""
    versions: dict[str, str] = {}
    for name in _PACKAGES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            continue
    return versions


@dataclass(frozen=True)
class _Contents:
    """A file's digest and what it imports."""

    sha256: str
    imports: tuple[tuple[str, tuple[str, ...]], ...] = ()
    """Module, with leading dots, and names taken from it, of each import anywhere in the file."""
    computed: bool = False
    """Whether it may also import by a name that is known only when it runs."""


_read: dict[str, _Contents] = {}
"""By digest: a file is taken apart once."""
_loaded: WeakKeyDictionary[ModuleType, _Contents] = WeakKeyDictionary()
"""Contents of a module when it was first looked up: later edits do not reach what is loaded."""


def _contents(name: str, path: Path) -> _Contents:
    """Return the contents of module `name`, in `path`; no imports where Python cannot read it.

    Of a module that this process has imported they stay what they were at the first call, because
    what runs here does not change with the file. `OSError` when the file cannot be read.
    """
    module = sys.modules.get(name)
    file = getattr(module, "__file__", None)
    mine = module if file and os.path.realpath(file) == os.path.realpath(path) else None
    if mine is not None and mine in _loaded:
        return _loaded[mine]
    source = path.read_bytes()
    digest = sha256(source).hexdigest()
    if digest not in _read:
        imports: list[tuple[str, tuple[str, ...]]] = []
        waiting: list[ast.AST] = []
        if path.suffix == ".py":
            try:
                waiting += ast.parse(source).body
            except (SyntaxError, ValueError, RecursionError):
                source = b""
        while waiting:  # statements alone: imports stand in no expression
            node = waiting.pop()
            if isinstance(node, ast.Import):
                imports += [(alias.name, ()) for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                names = tuple(alias.name for alias in node.names if alias.name != "*")
                imports.append(("." * node.level + (node.module or ""), names))
            test = getattr(node, "test", None)
            typed = "TYPE_CHECKING" in (getattr(test, "attr", ""), getattr(test, "id", ""))
            for inner in ("body", "orelse", "finalbody", "handlers", "cases"):
                children = () if typed and inner == "body" else getattr(node, inner, ())
                waiting += children if isinstance(children, list) else ()
        computed = path.suffix == ".py" and any(word in source for word in _COMPUTED)
        _read[digest] = _Contents(digest, tuple(imports), computed)
    if mine is not None:
        _loaded[mine] = _read[digest]
    return _read[digest]
