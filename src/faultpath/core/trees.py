"""The source trees that a system's code comes from, and the installed packages beside them."""

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

from faultpath.core.error_source import ours

_INSTALLED = frozenset({"site-packages", "dist-packages"})
_PACKAGES = ("numpy", "scipy", "pydantic", "pyarrow", "array-api-compat", "torch", "mujoco")
_NO_SOURCE = frozenset({"__pycache__", "node_modules"})
_NO_TREE = ("pyvenv.cfg", "manifest.json")
"""Files of folders that hold no sources of a system: a virtual environment, a run."""
_SUFFIXES = (".py", *EXTENSION_SUFFIXES)
_MOST = 20_000
"""Files and folders in a tree; one with more is no project's."""
_IMPORT = re.compile(
    r"(?:^|[;:])[ \t]*(?:from[ \t]+(\w+)[\w.]*[ \t]+import\b|import[ \t]+([\w., \t]+))", re.M
)
_REQUIRES = re.compile(r"^Requires-Dist: *([\w.-]+)(?!.*(?:extra|platform|os_name))", re.M)
"""Distribution that another needs on every machine."""


@dataclass(frozen=True)
class Root:
    """A module to start from: its name, and its file where it cannot be found by its name."""

    module: str
    file: Path | None = None

    @property
    def path(self) -> Path | None:
        """The file of the module, where it was imported or has no other name."""
        file = getattr(sys.modules.get(self.module), "__file__", None)
        return self.file or (Path(file) if file else None)


@dataclass(frozen=True)
class Tree:
    """The sources of a package, or of a folder from which modules are imported by their names."""

    folder: Path
    package: str
    """Name of the package; empty for a folder."""
    digests: Mapping[Path, str]
    """SHA-256 of each source."""

    def of(self, place: Path) -> dict[Path, str]:
        """Return the digests of a file, or of all files in a folder."""
        within = (path for path in self.digests if path == place or place in path.parents)
        return {path: self.digests[path] for path in within}


def trees_of(roots: Iterable[Root]) -> tuple[list[Tree], set[str]]:
    """Return the trees of some modules, and the installed packages that these import, by name.

    The tree of a module in a package is the package. Of any other it is the folder of its file,
    with the folders below except hidden ones, virtual environments, run folders, `__pycache__` and
    `node_modules`. A home directory, the folder for temporary files, the root of a file system, and
    what holds more than 20,000 files and folders are no project: only the files beside count there.
    Where what is imported comes from another folder of the user's, its tree counts too.
    """
    trees: list[Tree] = []
    names, others = set[str](), set[str]()
    waiting = [(root.module.partition(".")[0], root.file) for root in roots]
    for package, file in waiting:  # it grows on the way
        for place in (Path(os.path.realpath(p)) for p in ([file] if file else places(package))):
            tree = next((tree for tree in trees if tree.of(place)), None)
            if tree is None:
                trees.append(tree := _tree(place, package))
            for name in sorted(_names(tree.of(place)) - names):
                names.add(name)
                kinds = {kind_of(path / "__init__.py") for path in places(name)}
                if kinds and (ours(name) or ("local" in kinds and not ours(package))):
                    waiting.append((name, None))
                elif "installed" in kinds:
                    others.add(name)
    return trees, others


def _tree(place: Path, package: str) -> Tree:
    if place.is_dir():
        return Tree(place, package, _digests(_sources(place)))
    folder, files = place.parent, list[Path]()
    if folder not in (Path.home(), Path(folder.anchor), Path(os.path.realpath(gettempdir()))):
        files = _sources(folder)
    if not files:
        beside = next(os.walk(folder), (None, (), ()))[2]
        files = [folder / name for name in sorted(beside) if name.endswith(_SUFFIXES)]
    return Tree(folder, "", _digests((*files, place)))


def _sources(folder: Path) -> list[Path]:
    """Return the sources in and below a folder; none where there is too much."""
    sources: list[Path] = []
    count = 0
    for place, folders, files in os.walk(folder):
        count += len(folders) + len(files)
        if count > _MOST:
            return []
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".")
            and name not in _NO_SOURCE
            and not any(os.path.exists(os.path.join(place, name, file)) for file in _NO_TREE)
        )
        sources += (Path(place, name) for name in sorted(files) if name.endswith(_SUFFIXES))
    return sources


def places(package: str) -> list[Path]:
    """Return the folders of a top-level package, or the file of a module; empty without one.

    Looking for it runs nothing.
    """
    try:
        spec = getattr(sys.modules.get(package), "__spec__", None) or find_spec(package)
    except (ImportError, AttributeError, ValueError):
        return []
    if spec is None or package in sys.stdlib_module_names:
        return []
    origin = [spec.origin] if spec.has_location and spec.origin else []
    places = origin if spec.submodule_search_locations is None else spec.submodule_search_locations
    return [place for place in map(Path, places) if place.exists()]  # one may lie in an archive


_loaded: WeakKeyDictionary[ModuleType, str] = WeakKeyDictionary()
"""Digest of a module's file when it was first looked up: later edits do not reach what is loaded,
and what runs here does not change with the file."""
_imports: dict[str, set[str]] = {}
"""First names of what a source imports, by its digest."""


def _digests(files: Iterable[Path]) -> dict[Path, str]:
    """Return the SHA-256 of each file that can be read, as it was loaded."""
    modules = loaded()
    digests: dict[Path, str] = {}
    for path in files:
        module = modules.get(str(path))
        if module is not None and module in _loaded:
            digests[path] = _loaded[module]
            continue
        try:
            source = path.read_bytes()
        except OSError:  # nothing of it can run
            continue
        digests[path] = sha256(source).hexdigest()
        if digests[path] not in _imports:
            text = source.decode(errors="replace") if path.suffix == ".py" else ""
            _imports[digests[path]] = _imported(text)
        if module is not None:
            _loaded[module] = digests[path]
    return digests


def loaded() -> dict[str, ModuleType]:
    """Return the modules that this process has imported, by file."""
    modules = [(getattr(m, "__file__", None), m) for m in tuple(sys.modules.values())]
    return {_real(file): module for file, module in modules if isinstance(file, str)}


@cache
def _real(path: str) -> str:
    return os.path.realpath(path)


def imported(files: Iterable[Path]) -> set[str]:
    """Return the first names of what some sources import."""
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
    """Return whose a file is, by where it lies: Python's, an installed package's, the user's."""
    real = os.path.realpath(path.parent) + os.sep

    def lies_in(*names: str) -> bool:
        folders = filter(None, map(sysconfig.get_path, names))
        return real.startswith(tuple(os.path.realpath(folder) + os.sep for folder in folders))

    if not _INSTALLED.isdisjoint(path.parent.parts) or lies_in("purelib", "platlib"):
        return "installed"
    return "standard" if lies_in("stdlib", "platstdlib") else "local"


@cache
def _installed() -> dict[str, Path]:
    """Return where the metadata of each installed distribution are, by name, spelled with `_`."""
    places = [Path(place) for place in sys.path if _INSTALLED & {*Path(place).parts}]
    entries = [entry for place in places for entry in sorted(place.glob("*.dist-info"))]
    return {_spelled(entry.name.partition("-")[0]): entry for entry in reversed(entries)}


def _spelled(name: str) -> str:
    return re.sub(r"[-_.]+", "_", name).lower()


@cache
def _holder(package: str) -> str:
    """Return the distribution that holds a top-level package; empty without one."""
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
    """Return the version of the distribution that holds a top-level package, `None` without one.

    One that was installed from a folder or an archive of the user's own keeps its version while
    its contents change; a digest of what was installed stands beside it.
    """
    entry = _installed().get(_holder(package))
    if entry is None:
        return None
    version = entry.stem.partition("-")[2]
    if not (entry / "direct_url.json").exists():
        return version
    lines = (line for line in _text(entry / "RECORD").splitlines() if "sha256=" in line)
    records = sorted(line for line in lines if "dist-info" not in line)
    return f"{version} ({sha256(repr(records).encode()).hexdigest()[:16]})"


def releases(packages: Iterable[str]) -> dict[str, str]:
    """Return the versions of installed packages and of all that they require, by distribution."""
    names = [name for package in sorted(packages) if (name := _holder(package))]
    for name in names:  # it grows on the way
        for line in _REQUIRES.findall(_text(_installed()[name] / "METADATA")):
            required = _spelled(line)
            if required in _installed() and required not in names:
                names.append(required)
    return {name: version for name in names if (version := release(name))}


def packages() -> dict[str, str]:
    """Return the versions of the packages that numbers depend on, of those installed."""
    return {name: version for name in _PACKAGES if (version := release(name))}
