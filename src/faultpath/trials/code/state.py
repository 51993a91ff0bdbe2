"""The state of the code behind a result: one digest, and what it is made of."""

import gc
import json
import platform
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import file_digest, sha256
from pathlib import Path

from pydantic import Field

from faultpath.core.errors import UserError
from faultpath.core.files.opening import opened
from faultpath.core.frozen import Frozen
from faultpath.trials.code.graph import Graph, Root

_NAMED = 3


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
    """What the system says of itself beside."""

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
        found = [
            *_differences(self.files, other.files),
            *_differences(self.data, other.data),
            *_differences(self.packages, other.packages),
        ]
        if self.python != other.python:
            found.append("Python")
        if self.given != other.given:
            found.append("what fingerprint() returns")
        return tuple(found)


def named(names: Sequence[str]) -> str:
    """Name the first few of some names and count the others."""
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {more} more" if more > 0 else "")


_Stamp = tuple[int, int, int]


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
        found: list[str] = []
        for name, path in self._files.items():
            stamp = _stamp(path)
            if stamp is not None and stamp == self._stamps[name]:
                continue
            if stamp is None or _digest(path) != self._digests[name]:
                found.append(name)
            else:
                self._stamps[name] = stamp
        return tuple(found)


def _stamp(path: Path) -> _Stamp | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


def read_code(
    roots: Iterable[Root], data: Iterable[Path] = (), base: Path | None = None, given: str = ""
) -> Code:
    """Return what `roots` import, with some data files and folders.

    Paths of data are taken from `base`. `UserError` for a file that cannot be read.
    """
    graph, roots = Graph(), tuple(roots)
    collects = gc.isenabled()
    gc.disable()  # it would look through all of torch for the sake of syntax trees
    try:
        for root in roots:
            graph.add(root)
    finally:
        if collects:
            gc.enable()
    sources = dict(sorted(graph.files.items()))
    files: dict[str, tuple[Path, str]] = {}
    base = base or Path()
    for path in data:
        place = base / path
        try:
            held = [p for p in place.rglob("*") if p.is_file()] if place.is_dir() else [place]
            for file in held:
                name = file.relative_to(base) if file.is_relative_to(base) else file
                files[name.as_posix()] = file, _digest(file)
        except OSError as error:
            raise UserError(
                f"cannot read {place} ({error.strerror}), which the system names among its data "
                "files: put it there, or take it out of data_files"
            ) from error
    state = CodeState(
        files={name: digest for name, (_, digest) in sources.items()},
        data={name: digest for name, (_, digest) in sorted(files.items())},
        packages=dict(sorted(graph.packages.items())),
        python=platform.python_version(),
        given=given,
    )
    return Code(
        state,
        {name: path for name, (path, _) in sources.items()},
        {name: path for name, (path, _) in sorted(files.items())},
        roots[0].path if roots else None,
    )


def _digest(path: Path) -> str:
    with opened(path, sys.maxsize) as file:
        return file_digest(file, "sha256").hexdigest()


def _differences(mine: dict[str, str], theirs: dict[str, str]) -> list[str]:
    return sorted(name for name in {*mine, *theirs} if mine.get(name) != theirs.get(name))


def _hash(content: object) -> str:
    return sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]
