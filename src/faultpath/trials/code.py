"""The state of the code behind a result: one digest, and what it is made of."""

import gc
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
from faultpath.trials.arm import SystemSpec
from faultpath.trials.checks import paths_of
from faultpath.trials.declared import shown
from faultpath.trials.imports import ImportGraph, Root
from faultpath.trials.registry import factory_root
from faultpath.trials.system import System

_NAMED = 3
_ATTEMPT = Root("faultpath.trials.attempt")
"""Module that runs a trial, whichever system it is."""


class CodeState(Frozen):
    """Digests of everything outside installed packages that decides a result, and versions."""

    files: dict[str, str]
    """SHA-256 of each source file, by module."""
    data: dict[str, str] = Field(default_factory=dict[str, str])
    """SHA-256 of each data file."""
    packages: dict[str, str]
    """Versions of the installed packages that these files import."""
    python: str
    given: str = ""
    """Text of the system's `fingerprint()`, after its source where no file holds that."""

    @property
    def digest(self) -> str:
        """Hash of all of it."""
        return _hash(self.model_dump(mode="json"))

    @property
    def contents(self) -> str:
        """Hash of all but the versions of packages and Python."""
        return _hash([self.files, self.data, self.given])

    def changed(self, other: "CodeState") -> tuple[str, ...]:
        """Say what `other` has otherwise: files, data files, packages, Python."""
        changes: list[str] = []
        for mine, theirs in (
            (self.files, other.files),
            (self.data, other.data),
            (self.packages, other.packages),
        ):
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
    sources: Mapping[str, Path]
    data: Mapping[str, Path]
    main: Path | None = None
    """The file of the first module that it was followed from."""

    def unread(self) -> "Watch":
        """Watch what this process may still read: data files, and modules not imported yet."""
        loaded = {getattr(module, "__file__", None) for module in tuple(sys.modules.values())}
        late = {name: path for name, path in self.sources.items() if str(path) not in loaded}
        return Watch({**late, **self.data}, {**self.state.files, **self.state.data})


class Watch:
    """Files that a process may still read, such as weights and modules imported late.

    A glance costs one `stat` a file; contents are compared only where that shows another time,
    size or file.
    """

    def __init__(self, files: Mapping[str, Path], digests: Mapping[str, str]) -> None:
        self._files, self._digests = files, digests
        self._stamps = {name: _stamp(path) for name, path in files.items()}

    def changed(self) -> tuple[str, ...]:
        """Return the names of the files whose contents are not what they were."""
        names: list[str] = []
        for name, path in self._files.items():
            stamp = _stamp(path)
            if stamp is not None and stamp == self._stamps[name]:
                continue
            if stamp is None or _digest(path) != self._digests[name]:
                names.append(name)
            else:
                self._stamps[name] = stamp
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
    """Return what `roots` import, with some data files and folders.

    Paths of data are taken from `base`. `UserError` for a file that cannot be read.
    """
    graph, roots, base = ImportGraph(), tuple(roots), base or Path()
    collects = gc.isenabled()
    gc.disable()  # it would look through all of torch for the sake of syntax trees
    try:
        for root in roots:
            graph.add(root)
    finally:
        if collects:
            gc.enable()
    files: dict[str, tuple[Path, str]] = {}
    for place in (base / path for path in data):
        try:
            paths = [p for p in place.rglob("*") if p.is_file()] if place.is_dir() else [place]
            for file in paths:
                name = file.relative_to(base) if file.is_relative_to(base) else file
                files[name.as_posix()] = file, _digest(file)
        except OSError as error:
            raise UserError(
                f"cannot read {place} ({error.strerror}), which the system names among its data "
                "files: put it there, or take it out of data_files"
            ) from error
    sources, files = dict(sorted(graph.files.items())), dict(sorted(files.items()))
    state = CodeState(
        files={name: digest for name, (_, digest) in sources.items()},
        data={name: digest for name, (_, digest) in files.items()},
        packages=dict(sorted(graph.packages.items())),
        python=platform.python_version(),
        given=fingerprint,
    )
    return Code(
        state,
        {name: path for name, (path, _) in sources.items()},
        {name: path for name, (path, _) in files.items()},
        roots[0].path if roots else None,
    )


def system_code(system: System, spec: SystemSpec) -> Code:
    """Return the code and data that `system`, built from `spec`, runs with, in their state.

    Its own modules and all that they import, faultpath's included, those of parts that the user
    named, the data files that it names, and what its `fingerprint()` says. Of an object that
    nothing can build again, that is the file of its class, or its source where it was typed into a
    notebook. `UserError` for a data file that cannot be read.
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
        elif root is None or name != root.module:
            findable = getattr(module, "__spec__", None) is not None
            classes[name] = Root(name, None if findable else Path(file), of_system=False)
    if root is None:
        with suppress(OSError, TypeError):
            fingerprint = inspect.getsource(type(system)) + fingerprint
    parts = (factory_root(SystemSpec(name=str(name))) for name in paths_of(system, "parts"))
    code = read_code(
        ((root,) if root else ()) + (*classes.values(), *parts, _ATTEMPT),
        data=map(Path, paths_of(system, "data_files")),
        base=root.path.parent if root and root.path else None,
        fingerprint=fingerprint,
    )
    return code if root else replace(code, main=None)


def source_state(spec: SystemSpec) -> CodeState:
    """Return the state of the code that building `spec` will load, without loading it."""
    return read_code((factory_root(spec), _ATTEMPT)).state


def _digest(path: Path) -> str:
    with opened(path, sys.maxsize) as file:
        return file_digest(file, "sha256").hexdigest()


def _hash(content: object) -> str:
    return sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]
