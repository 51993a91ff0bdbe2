"""What a source file holds: its digest and its imports, as this process runs it."""

import os
import sys
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from types import ModuleType
from weakref import WeakKeyDictionary

from faultpath.code.imports import Imports, imports_of


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
