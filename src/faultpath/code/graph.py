"""From a module to every file that it may run, by following imports."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from faultpath.code.imports import Import, contents
from faultpath.code.places import Kind, file_of, kind_of, locate, release

_OURS = "faultpath"
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
        spec = locate(self.module) if self.file is None else None
        return self.file if spec is None else file_of(spec)


class Graph:
    """The files and installed packages that some modules reach.

    Files count wherever an import of them stands, so that one inside a function counts before it
    runs. A module that imports by a computed name may load whatever lies beside and below it:
    all of that counts. Installed packages are not entered, except those that hold a root.

    Of faultpath's own packages the `__init__` files only pass names on. They are looked through
    for the module that a name comes from: importing one name would else reach the whole package,
    and a change of a report would count as a change of every flight.
    """

    def __init__(self) -> None:
        self.files: dict[str, tuple[Path, str]] = {}
        """By name: the file and the digest of its contents."""
        self.packages: dict[str, str] = {}
        """Versions of what is installed, by top-level package."""
        self._entered: set[str] = set()
        self._seen: set[tuple[str, bool]] = set()
        self._paths: set[Path] = set()

    @property
    def modules(self) -> frozenset[str]:
        """Names of all modules that were asked for, whether they are there or not."""
        return frozenset(name for name, _ in self._seen)

    def add(self, root: Root) -> None:
        """Follow everything that a root imports."""
        if root.of_system:
            self._entered.add(root.module.partition(".")[0])
        if root.file is None:
            self._module(root.module)
        else:
            self._file(root.file, root.file.name, "", root.module)

    def _module(self, name: str) -> None:
        """Take in a module and, as an import does, the packages that it lies in."""
        parts = name.split(".")
        for end in range(1, len(parts) + 1):
            self._one(".".join(parts[:end]), passing=end < len(parts))

    def _one(self, name: str, passing: bool) -> None:
        if (name, passing) in self._seen or (name, False) in self._seen:
            return
        self._seen.add((name, passing))
        if name == _OURS:
            return  # it hands on the front door, which decides no result, to whoever asks for it
        spec = locate(name)
        path = None if spec is None else file_of(spec)
        if spec is None or path is None:
            return
        top = name.partition(".")[0]
        if top != _OURS:
            kind = kind_of(path)
            if kind is Kind.STANDARD:
                return
            if kind is Kind.INSTALLED and top not in self._entered:
                version = self.packages.get(top) or release(top)
                if version is not None:
                    self.packages[top] = version
                    return
        package = name if spec.submodule_search_locations is not None else name.rpartition(".")[0]
        if passing and top == _OURS and contents(name, path).imports.facade:
            return
        self._file(path, _file_name(name, path), package, name)

    def _file(self, path: Path, label: str, package: str, name: str) -> None:
        path = Path(os.path.realpath(path))
        if path in self._paths:
            return
        self._paths.add(path)
        found = contents(name, path)
        if label in self.files:
            label = f"{path.parent.name}/{label}"
        self.files[label] = (path, found.sha256)
        for each in found.imports.imports:
            self._follow(each, package)
        if found.imports.computed and not name.startswith(f"{_OURS}."):
            for beside in _sources(path.parent):
                parts = beside.relative_to(path.parent).with_suffix("").parts
                inside = ".".join(part for part in (package, *parts[:-1]) if part)
                below = beside.relative_to(path.parent.parent).as_posix()
                self._file(beside, below, inside, ".".join((package, *parts)).strip("."))

    def _follow(self, each: Import, package: str) -> None:
        base = _absolute(each, package)
        if not base:
            return
        if not each.names:
            self._module(base)
            return
        for name, _ in each.names:
            if name == "*":
                self._module(base)
            elif not self._passed_on(base, name):
                self._module(base)
                self._module(f"{base}.{name}")

    def _passed_on(self, base: str, name: str) -> bool:
        """Follow a name of one of faultpath's facades to where it comes from, if it is one."""
        if base.partition(".")[0] != _OURS:
            return False
        spec = locate(base)
        path = None if spec is None else file_of(spec)
        if spec is None or path is None or spec.submodule_search_locations is None:
            return False
        found = contents(base, path).imports
        if not found.facade:
            return False
        for each in found.imports:
            for original, here in each.names:
                if here == name:
                    self._follow(Import(each.module, ((original, original),), each.level), base)
                    return True
        self._module(f"{base}.{name}")
        return True


def _absolute(each: Import, package: str) -> str:
    if not each.level:
        return each.module
    parts = package.split(".")
    if not package or each.level > len(parts):
        return each.module if not package else ""  # a file of its own has no package to look in
    return ".".join((*parts[: len(parts) - each.level + 1], *filter(None, (each.module,))))


def _file_name(name: str, path: Path) -> str:
    stem = name.replace(".", "/")
    return f"{stem}/{path.name}" if path.stem == "__init__" else f"{stem}{path.suffix}"


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


@dataclass(frozen=True)
class Shadowed:
    """A module that is another one than the folder's own."""

    module: str
    found: Path
    own: Path


def shadowed(root: Root, folder: Path) -> Shadowed | None:
    """Return the first module that `root` imports and that is not the one in `folder`.

    A process holds one module of a name. Where two systems have a `helper.py` each, the second
    would run the first one's, and its own would count for nothing. Modules of Python and of
    installed packages go before a file of that name, as everybody expects who writes
    `import logging` in a package that has a `logging.py`.
    """
    graph = Graph()
    graph.add(root)
    for name in sorted(graph.modules):
        own, spec = _own(name, folder), locate(name)
        found = None if spec is None else file_of(spec)
        if own is None or found is None or name.partition(".")[0] == "faultpath":
            continue
        if os.path.realpath(own) != os.path.realpath(found) and kind_of(found) is Kind.LOCAL:
            return Shadowed(name, found, own)
    return None


def _own(name: str, folder: Path) -> Path | None:
    place = folder.joinpath(*name.split("."))
    files = (place / "__init__.py", place.with_name(f"{place.name}.py"))
    return next((file for file in files if os.path.isfile(file)), None)
