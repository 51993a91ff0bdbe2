"""Where modules lie, found without importing them, and which of them are installed."""

import os
import sys
import sysconfig
from collections.abc import Iterable
from enum import Enum
from functools import cache
from hashlib import sha256
from importlib.machinery import ModuleSpec
from importlib.metadata import Distribution, PackageNotFoundError, distribution, distributions
from pathlib import Path

_INSTALLED = frozenset({"site-packages", "dist-packages"})


def locate(name: str) -> ModuleSpec | None:
    """Return where a module comes from, `None` for one that is not there.

    One that this process has imported comes from where it was found; any other is looked for as
    an import would, except that no package is run on the way.
    """
    loaded = getattr(sys.modules.get(name), "__spec__", None)
    if loaded is not None:
        return loaded
    parent, _, _ = name.rpartition(".")
    path = None
    if parent:
        package = locate(parent)
        if package is None or package.submodule_search_locations is None:
            return None
        path = package.submodule_search_locations
    for finder in sys.meta_path:
        try:
            spec = finder.find_spec(name, path)
        except (ImportError, AttributeError, ValueError):
            continue
        except KeyError:  # a folder without `__init__.py` whose parent is not imported
            spec = _plain_folder(name, path or ())
        if spec is not None:
            return spec
    return None


def _plain_folder(name: str, path: Iterable[str]) -> ModuleSpec | None:
    """Return a namespace package below a package that is not imported.

    Python's own finder looks the parent up among the imported modules to follow its path.
    """
    found = [str(place) for each in path if (place := Path(each, name.rpartition(".")[2])).is_dir()]
    if not found:
        return None
    spec = ModuleSpec(name, None, is_package=True)
    spec.submodule_search_locations = found
    return spec


def file_of(spec: ModuleSpec) -> Path | None:
    """Return the file of a module, `None` for a built-in one or a package without a file."""
    if not spec.has_location or spec.origin is None:
        return None
    path = Path(spec.origin)
    archive = getattr(spec.loader, "archive", None)
    return path if path.is_file() or archive is None else Path(archive)


class Kind(Enum):
    """Whose a file is."""

    STANDARD = "part of Python"
    INSTALLED = "part of an installed package"
    LOCAL = "the user's own"


def kind_of(path: Path) -> Kind:
    """Return whose a file is, by where it lies."""
    return _kind_in(path.parent)


@cache
def _kind_in(folder: Path) -> Kind:
    real = os.path.realpath(folder) + os.sep
    if not _INSTALLED.isdisjoint(folder.parts) or real.startswith(_folders("purelib", "platlib")):
        return Kind.INSTALLED
    return Kind.STANDARD if real.startswith(_folders("stdlib", "platstdlib")) else Kind.LOCAL


@cache
def release(package: str) -> str | None:
    """Return the version of the distribution that holds a top-level package, `None` without one.

    One that was installed from a folder or an archive of the user's own keeps its version while
    its contents change; a digest of what was installed stands beside it.
    """
    if package in sys.stdlib_module_names:  # no distribution has them, and looking takes seconds
        return None
    found = _distribution(package)
    if found is None:
        return None
    version = found.version
    if found.read_text("direct_url.json") is not None:
        lines = (found.read_text("RECORD") or "").splitlines()
        contents = sorted(line for line in lines if "sha256=" in line and "dist-info" not in line)
        version += f" ({sha256(repr(contents).encode()).hexdigest()[:16]})"
    return version


def _distribution(package: str) -> Distribution | None:
    try:
        return distribution(package)
    except (PackageNotFoundError, ValueError):
        pass
    for found in distributions():  # the common case reads one small file each
        if package in (found.read_text("top_level.txt") or "").split():
            return found
    for found in distributions():
        if any(Path(file).parts[0].partition(".")[0] == package for file in found.files or ()):
            return found
    return None


@cache
def _folders(*names: str) -> tuple[str, ...]:
    paths = (sysconfig.get_path(name) for name in names)
    return tuple(dict.fromkeys(os.path.realpath(path) + os.sep for path in paths if path))
