"""Whose a module is, the source trees of a system's code, and the packages that it imports."""

import os
import re
import sys
import sysconfig
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import find_spec
from pathlib import Path
from tempfile import gettempdir
from types import ModuleType
from typing import Literal
from weakref import WeakKeyDictionary

_INSTALLED = frozenset({"site-packages", "dist-packages"})
_PACKAGES = ("numpy", "scipy", "pydantic", "pyarrow", "array-api-compat", "torch", "mujoco")
_NO_SOURCE = frozenset({"__pycache__", "node_modules"})
_NO_TREE = ("pyvenv.cfg", "manifest.json")
"""Files of folders that hold no sources of a system: a virtual environment, a run."""
_SUFFIXES = (".py", *EXTENSION_SUFFIXES)
_MOST = 20_000
"""Files and folders of a tree; one with more is no project."""
_IMPORT = re.compile(
    r"(?:^|[;:])[ \t]*(?:from[ \t]+(\w+)[\w.]*[ \t]+import\b|import[ \t]+([\w., \t]+))", re.M
)
_REQUIRES = re.compile(r"^Requires-Dist: *([\w.-]+)(?!.*(?:extra|platform|os_name))", re.M)
"""A requirement that holds on every machine."""


def ours(module: str) -> bool:
    """Return whether a module is the engine's or that of a distribution named `faultpath_...`.

    Modules named `faultpath_system_...` are users' files, which the registry loads by that name.
    """
    top = module.partition(".")[0]
    return top == "faultpath" or (top.startswith("faultpath_") and "_system_" not in top)


@dataclass(frozen=True)
class Root:
    """A module to start from: its name, and its file if it cannot be found by name."""

    module: str
    file: Path | None = None

    @property
    def path(self) -> Path | None:
        """File of the module, if it was imported or is not found by name."""
        file = getattr(sys.modules.get(self.module), "__file__", None)
        return self.file or (Path(file) if file else None)


@dataclass(frozen=True)
class Tree:
    """The sources of a package, or of a folder whose modules are imported by name."""

    folder: Path
    package: str
    """Name of the package; empty for a folder."""
    digests: Mapping[Path, str]
    """SHA-256 of each source."""

    def of(self, location: Path) -> dict[Path, str]:
        """Return the digests of a file, or of all files in a folder."""
        within = (path for path in self.digests if path == location or location in path.parents)
        return {path: self.digests[path] for path in within}


def trees_of(roots: Iterable[Root]) -> tuple[list[Tree], set[str]]:
    """Return the trees of some modules, and the names of the installed packages they import.

    The tree of a module in a package is the package. Of any other it is the folder of its file,
    with the folders below except hidden ones, virtual environments, run folders, `__pycache__` and
    `node_modules`. A home directory, the folder for temporary files, the root of a file system, and
    a folder with more than 20,000 files and folders are no project: there only the files beside the
    module count. A module that is imported from another folder of the user's adds its tree.
    """
    trees: list[Tree] = []
    names, others = set[str](), set[str]()
    waiting = [(root.module.partition(".")[0], root.file) for root in roots]
    for package, file in waiting:  # the loop itself adds to it
        for path in map(Path, map(os.path.realpath, [file] if file else package_paths(package))):
            tree = next((tree for tree in trees if tree.of(path)), None)
            if tree is None:
                trees.append(tree := _tree(path, package))
            for name in sorted(_names(tree.of(path)) - names):
                names.add(name)
                kinds = {kind_of(folder / "__init__.py") for folder in package_paths(name)}
                if kinds and (ours(name) or ("local" in kinds and not ours(package))):
                    waiting.append((name, None))
                elif "installed" in kinds:
                    others.add(name)
    return trees, others


def _tree(path: Path, package: str) -> Tree:
    if path.is_dir():
        return Tree(path, package, _digests(_sources(path)))
    folder, files = path.parent, list[Path]()
    if folder not in (Path.home(), Path(folder.anchor), Path(os.path.realpath(gettempdir()))):
        files = _sources(folder)
    if not files:
        beside = next(os.walk(folder), (None, (), ()))[2]
        files = [folder / name for name in sorted(beside) if name.endswith(_SUFFIXES)]
    return Tree(folder, "", _digests((*files, path)))


def _sources(folder: Path) -> list[Path]:
    """Return the sources in and below a folder; none if it is too large for a project."""
    sources: list[Path] = []
    count = 0
    for parent, folders, files in os.walk(folder):
        count += len(folders) + len(files)
        if count > _MOST:
            return []
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".")
            and name not in _NO_SOURCE
            and not any(os.path.exists(os.path.join(parent, name, file)) for file in _NO_TREE)
        )
        sources += (Path(parent, name) for name in sorted(files) if name.endswith(_SUFFIXES))
    return sources


def package_paths(package: str) -> list[Path]:
    """Return the folders of a top-level package, or the file of a module; empty without one.

    It runs no code of the package.
    """
    try:
        spec = getattr(sys.modules.get(package), "__spec__", None) or find_spec(package)
    except (ImportError, AttributeError, ValueError):
        return []
    if spec is None or package in sys.stdlib_module_names:
        return []
    origin = [spec.origin] if spec.has_location and spec.origin else []
    folders = spec.submodule_search_locations
    paths = map(Path, origin if folders is None else folders)
    return [path for path in paths if path.exists()]  # one may lie in an archive


_loaded: WeakKeyDictionary[ModuleType, str] = WeakKeyDictionary()
"""Digest of a module's file when it was first looked up, since later edits of the file do not reach
the loaded module."""
_imports: dict[str, set[str]] = {}
"""Top-level packages that a source imports, by its digest."""


def _digests(files: Iterable[Path]) -> dict[Path, str]:
    """Return the SHA-256 of each readable file, as it was when it was loaded."""
    modules = loaded()
    digests: dict[Path, str] = {}
    for path in files:
        module = modules.get(str(path))
        if module is not None and module in _loaded:
            digests[path] = _loaded[module]
            continue
        try:
            source = path.read_bytes()
        except OSError:  # what cannot be read cannot run either
            continue
        digests[path] = sha256(source).hexdigest()
        if digests[path] not in _imports:
            text = source.decode(errors="replace") if path.suffix == ".py" else ""
            _imports[digests[path]] = _imported(text)
        if module is not None:
            _loaded[module] = digests[path]
    return digests


def keep_digests(folder: Path) -> None:
    """Note the digests of the user's modules under a folder that this process has imported.

    An edit after that, while a system builds, is not what was loaded.
    """
    files = [path for path in map(Path, loaded()) if path.is_relative_to(folder)]
    _digests(path for path in files if kind_of(path) == "local")


def loaded() -> dict[str, ModuleType]:
    """Return the modules that this process has imported, by file."""
    modules = [(getattr(m, "__file__", None), m) for m in tuple(sys.modules.values())]
    return {_real(file): module for file, module in modules if isinstance(file, str)}


@cache
def _real(path: str) -> str:
    return os.path.realpath(path)


def imported(files: Iterable[Path]) -> set[str]:
    """Return the top-level packages that some sources import."""
    return _names(_digests(files))


def _names(digests: Mapping[Path, str]) -> set[str]:
    return set[str]().union(*(_imports[digest] for digest in digests.values()))


def _imported(text: str) -> set[str]:
    names: set[str] = set()
    for module, several in _IMPORT.findall(text):
        names.update(re.split(r"[.\s]", name.strip())[0] for name in several.split(","))
        names.add(module)
    return names - {""}


@cache
def kind_of(path: Path) -> Literal["standard", "installed", "local"]:
    """Return the owner of a file by its folder: Python, an installed package, or the user."""
    real = os.path.realpath(path.parent) + os.sep

    def lies_in(*names: str) -> bool:
        folders = filter(None, map(sysconfig.get_path, names))
        return real.startswith(tuple(os.path.realpath(folder) + os.sep for folder in folders))

    if not _INSTALLED.isdisjoint(path.parent.parts) or lies_in("purelib", "platlib"):
        return "installed"
    return "standard" if lies_in("stdlib", "platstdlib") else "local"


@cache
def _installed() -> dict[str, Path]:
    """Return the metadata folder of each installed distribution, by name, spelled with `_`."""
    folders = [folder for folder in map(Path, sys.path) if _INSTALLED & {*folder.parts}]
    entries = [entry for folder in folders for entry in sorted(folder.glob("*.dist-info"))]
    return {_spelled(entry.name.partition("-")[0]): entry for entry in reversed(entries)}


def _spelled(name: str) -> str:
    return re.sub(r"[-_.]+", "_", name).lower()


@cache
def _distribution(package: str) -> str:
    """Return the distribution of a top-level package; empty without one."""
    if package in sys.stdlib_module_names:
        return ""
    if _spelled(package) in _installed():
        return _spelled(package)
    starts = tuple(f"\n{package}{end}" for end in ("/", ".py,"))
    for name, entry in _installed().items():
        records = f"\n{_text(entry / 'RECORD')}"
        if any(start in records for start in starts):
            return name
    return ""


def _text(file: Path) -> str:
    return file.read_text("utf-8") if file.exists() else ""


@cache
def release(package: str) -> str | None:
    """Return the version of a top-level package's distribution, `None` without one.

    A distribution installed from a folder or an archive of the user's own keeps its version while
    its contents change, so a digest of what was installed follows the version.
    """
    entry = _installed().get(_distribution(package))
    if entry is None:
        return None
    version = entry.stem.partition("-")[2]
    if not (entry / "direct_url.json").exists():
        return version
    lines = (line for line in _text(entry / "RECORD").splitlines() if "sha256=" in line)
    records = sorted(line for line in lines if "dist-info" not in line)
    return f"{version} ({sha256(repr(records).encode()).hexdigest()[:16]})"


def releases(packages: Iterable[str]) -> dict[str, str]:
    """Return the versions of installed packages and of their requirements, by distribution."""
    names = [name for package in sorted(packages) if (name := _distribution(package))]
    for name in names:  # the loop itself adds to it
        for line in _REQUIRES.findall(_text(_installed()[name] / "METADATA")):
            required = _spelled(line)
            if required in _installed() and required not in names:
                names.append(required)
    return {name: version for name in names if (version := release(name))}


def packages() -> dict[str, str]:
    """Return the versions of those installed packages on which numbers depend."""
    return {name: version for name in _PACKAGES if (version := release(name))}
