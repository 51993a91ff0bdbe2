"""The state of the code behind a result: one digest of sources, data and packages."""

import inspect
import json
import platform
import sys
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from hashlib import file_digest, sha256
from pathlib import Path

from pydantic import Field

from faultpath.core.errors import SystemMistake, UserError
from faultpath.core.files.opening import opened
from faultpath.core.results import Frozen
from faultpath.core.trees import Root, kind_of, loaded, releases, trees_of
from faultpath.faults.kinds import installed_kinds
from faultpath.run.plan import SystemSpec
from faultpath.run.registry import factory_root
from faultpath.system.checks import paths_of
from faultpath.system.declared import shown
from faultpath.system.system import System

_NAMED = 3


class CodeState(Frozen):
    """Digests of the sources and data that decide a result, and versions."""

    files: dict[str, str]
    """SHA-256 of each package, and of each file of a folder of the user's."""
    data: dict[str, str] = Field(default_factory=dict[str, str])
    """SHA-256 of each data file."""
    packages: dict[str, str]
    """Versions of the installed packages that these import, and of all that those require."""
    python: str
    given: str = ""
    """Text of the system's `fingerprint()`, after its source where no file holds that."""

    @property
    def digest(self) -> str:
        """Hash of all of it."""
        content = json.dumps(self.model_dump(mode="json"), sort_keys=True)
        return sha256(content.encode()).hexdigest()[:32]

    def changed(self, other: "CodeState") -> tuple[str, ...]:
        """Return what differs in `other`: files, data files, packages, Python."""
        changes: list[str] = []
        for field in ("files", "data", "packages"):
            mine: dict[str, str] = getattr(self, field)
            theirs: dict[str, str] = getattr(other, field)
            changes += sorted(n for n in {*mine, *theirs} if mine.get(n) != theirs.get(n))
        changes += ["Python"] * (self.python != other.python)
        changes += ["what fingerprint() returns"] * (self.given != other.given)
        return tuple(changes)


def named(names: Sequence[str]) -> str:
    """Name the first few of some names and count the others."""
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {more} more" if more > 0 else "")


@dataclass(frozen=True)
class Code:
    """The state of some code, and where its files are."""

    state: CodeState
    sources: Mapping[Path, str]
    """SHA-256 of each source, as this process loaded it."""
    data: Mapping[str, Path]
    imports: frozenset[str]
    """Installed packages that the sources import, by their names there."""
    main: Path | None = None
    """File of the module that builds the system, where a path names it."""


class Watch:
    """Files that a process may still read: data, and sources that it imports late.

    A glance costs one `stat` a file; contents are compared only where that shows another time,
    size or file.
    """

    def __init__(self, code: Code) -> None:
        self._data, self._digests = code.data, code.state.data
        self._stamps = {name: _stamp(path) for name, path in code.data.items()}
        before = loaded()
        self._late = {path: d for path, d in code.sources.items() if str(path) not in before}
        self._modules = len(sys.modules)

    def changed(self) -> tuple[str, ...]:
        """Return the names of the files whose contents are not what they were when read."""
        names: list[str] = []
        for name, path in self._data.items():
            stamp = _stamp(path)
            if stamp is not None and stamp == self._stamps[name]:
                continue
            if stamp is None or _digest(path) != self._digests[name]:
                names.append(name)
            else:
                self._stamps[name] = stamp
        if len(sys.modules) != self._modules:
            self._modules, modules = len(sys.modules), loaded()
            for path in [path for path in self._late if str(path) in modules]:
                digest = self._late.pop(path)
                names += [path.name] * (_stamp(path) is None or _digest(path) != digest)
        return tuple(names)


def _stamp(path: Path) -> tuple[int, int, int] | None:
    with suppress(OSError):
        stat = path.stat()
        return stat.st_mtime_ns, stat.st_size, stat.st_ino
    return None


def read_code(
    roots: Iterable[Root],
    data: Iterable[Path] = (),
    base: Path | None = None,
    fingerprint: str = "",
) -> Code:
    """Return the source trees of `roots` and of faultpath, with some data files and folders.

    Paths of data are taken from `base`. `UserError` for a file that cannot be read.
    """
    base = base or Path()
    trees, imports = trees_of((*roots, Root("faultpath")))
    sources: dict[str, str] = {}
    for tree in trees:
        names = {path.relative_to(tree.folder).as_posix(): d for path, d in tree.digests.items()}
        if tree.package:
            names = {tree.package: sha256(repr(sorted(names.items())).encode()).hexdigest()}
        above = tree.folder
        while not sources.keys().isdisjoint(names):
            names = {f"{above.name}/{name}": digest for name, digest in names.items()}
            above = above.parent
        sources.update(names)
    files: dict[str, Path] = {}
    digests: dict[str, str] = {}
    for place in (base / path for path in data):
        try:
            paths = sorted(place.rglob("*")) if place.is_dir() else [place]
            for file in (path for path in paths if not path.is_dir()):
                name = file.relative_to(base) if file.is_relative_to(base) else file
                files[name.as_posix()], digests[name.as_posix()] = file, _digest(file)
        except OSError as error:
            raise UserError(
                f"cannot read {error.filename or place} ({error.strerror}), which the system names "
                "among its data files: put it there, or take it out of data_files"
            ) from error
    return Code(
        state=CodeState(
            files=sources,
            data=digests,
            packages=releases(imports),
            python=platform.python_version(),
            given=fingerprint,
        ),
        sources={path: digest for tree in trees for path, digest in tree.digests.items()},
        data=files,
        imports=frozenset(imports),
    )


def system_code(system: System, spec: SystemSpec) -> Code:
    """Return the code and data that `system`, built from `spec`, runs with, in their state.

    The whole trees of its sources, of its classes', of parts that the user named, of installed
    kinds of fault and of faultpath, the data files that it names, and what its `fingerprint()`
    says. Of an object that nothing can build again, that is the file of its class, or its source
    where it was typed into a notebook.
    `UserError` for a data file that cannot be read.
    """
    fingerprint, root = system.fingerprint(), None if spec.is_object else factory_root(spec)
    # A user's class may return anything, whatever the type says.
    if not isinstance(fingerprint, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise SystemMistake(
            f"system '{system.name}': `fingerprint` returned {shown(fingerprint)}: it must return "
            "text"
        )
    classes: dict[str, Root] = {}
    for kind in type(system).__mro__:
        module, name = sys.modules.get(kind.__module__), kind.__module__
        file = getattr(module, "__file__", None)
        if not file or not Path(file).is_file():
            continue
        if kind is type(system) and spec.is_object:
            root = Root(name, Path(file))
        elif (root is None or name != root.module) and kind_of(Path(file)) == "local":
            findable = getattr(module, "__spec__", None) is not None
            classes[name] = Root(name, None if findable else Path(file))
    if root is None:
        with suppress(OSError, TypeError):
            fingerprint = inspect.getsource(type(system)) + fingerprint
    names = (*paths_of(system, "parts"), *installed_kinds().values())
    parts = (factory_root(SystemSpec(name=str(name))) for name in names)
    code = read_code(
        ((root,) if root else ()) + (*classes.values(), *parts),
        data=map(Path, paths_of(system, "data_files")),
        base=root.path.parent if root and root.path else None,
        fingerprint=fingerprint,
    )
    return replace(code, main=root.path) if root else code


def source_state(spec: SystemSpec) -> CodeState:
    """Return the state of the code that building `spec` will load, without loading it."""
    return read_code([factory_root(spec)]).state


def _digest(path: Path) -> str:
    with opened(path, sys.maxsize) as file:
        return file_digest(file, "sha256").hexdigest()
