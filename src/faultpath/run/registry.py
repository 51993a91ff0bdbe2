"""From the name of a system to the system, by import on demand."""

import importlib
import importlib.util
import inspect
import os
import sys
from collections.abc import Generator, Iterable, Sequence
from contextlib import contextmanager
from functools import cache
from hashlib import sha256
from importlib.machinery import (
    EXTENSION_SUFFIXES,
    SOURCE_SUFFIXES,
    ExtensionFileLoader,
    FileFinder,
    SourceFileLoader,
)
from importlib.metadata import entry_points
from pathlib import Path
from types import CodeType, ModuleType

from faultpath.core.error_source import described, note_system
from faultpath.core.error_source import location as where
from faultpath.core.errors import SystemMistake, UserError
from faultpath.core.text import extra
from faultpath.core.trees import Root, imported, keep_digests, kind_of, ours, package_paths
from faultpath.run.apart import FOLDER, reads, set_apart, working_directory
from faultpath.run.plan import SystemSpec
from faultpath.system.checks import check_system
from faultpath.system.options import Factory, Option, builds, call, options_of
from faultpath.system.system import System

_opened: dict[tuple[str, int], set[str]] = {}
"""By file and its time: what lies beside it is imported once, and what is opened then counts."""
_entered: dict[str, str] = {}
"""By system, the working directory that it entered; a module is imported once too."""
_EXTRAS = frozenset({"torch", "gymnasium"})


@cache
def installed_systems() -> dict[str, str]:
    """Return the factories that distributions declare, `module:factory` by the system's name."""
    return {entry.name: entry.value for entry in entry_points(group="faultpath.systems")}


def load_system(spec: SystemSpec) -> System:
    """Build the system that `spec` names.

    The name is that of an entry point in the group `faultpath.systems`, `module:attribute`, or
    `path/to/file.py:attribute`, the attribute being `create` where a file is named alone. The
    attribute is called with the options, see `faultpath.system.options`, and returns a `System`.
    `UserError` for a name, attribute or option that does not exist, a missing package, or a
    module of the system's own of which this process would run another one of that name.

    The caller's process stays as it was, but for the modules that the system imports and its folder
    at the end of `sys.path`. Where loading fails both are put back. A working directory that the
    system enters is that of its trials alone.
    """
    with _loading(spec.name):
        target = ":".join(_target(spec.name))
        try:
            system = call(_factory(spec.name), spec.options, f"system {spec.name!r}")
        except (Exception, SystemExit) as error:
            if isinstance(error, UserError) or _installed(spec.name) or where(error):
                raise  # what has no place is no code of anybody's
            raise SystemMistake(
                f"{target} builds no system ({described(error)}): name a function that returns one"
            ) from error
        if not isinstance(system, System):
            raise UserError(f"{target} returned a {type(system).__name__}: it must return a System")
        check_system(system, spec.name)
    vars(system)[FOLDER] = _entered.get(spec.name)
    return system


def opened_by(name: str) -> frozenset[str]:
    """Return the files that this process opened to read while it loaded the system `name`."""
    return frozenset(_opened.get(_version(name), ()))


def _version(name: str) -> tuple[str, int]:
    file = os.path.realpath(_target(name)[0])
    return file, os.stat(file).st_mtime_ns if os.path.isfile(file) else 0


def system_options(name: str) -> tuple[Option, ...]:
    """Return the options that the system `name` takes, without building it.

    A user's system is imported for that. `UserError` as `load_system`.
    """
    with _loading(name):
        return options_of(_factory(name))


def load_parts(names: Iterable[str], kinds: Sequence[type]) -> dict[str, Factory]:
    """Return what builds each part of their own that users name to a system, as they name systems.

    A module is loaded once, whatever number of factories it has. Raises as `load_system`, for what
    is not declared to return one of `kinds`.
    """
    modules: dict[str, ModuleType] = {}
    factories: dict[str, Factory] = {}
    for name in names:
        place, attribute = _split(name)
        with _loading(name):
            modules[place] = modules.get(place) or _module(place, name)
        factories[name] = _attribute(modules[place], place, attribute, kinds)
    return factories


def _factory(name: str) -> Factory:
    place, attribute = _target(name)
    kinds = () if _installed(name) else (System,)  # an entry point of the group is a declaration
    return _attribute(_module(place, name), place, attribute, kinds)


def _attribute(module: ModuleType, place: str, attribute: str, kinds: Sequence[type]) -> Factory:
    factory = getattr(module, attribute, None)
    if not callable(factory):
        raise UserError(f"{place} has no function {attribute!r} to build from: check the name")
    if kinds and not builds(factory, kinds):
        names = " or a ".join(kind.__name__ for kind in kinds)
        code, line = getattr(inspect.unwrap(factory), "__code__", None), ""
        if isinstance(code, CodeType) and code.co_filename == getattr(module, "__file__", None):
            line = f", line {code.co_firstlineno},"
        raise UserError(
            f"{place}{line} does not declare that {attribute!r} returns a {names}, and nothing "
            f"else is called: annotate it, as in `def {attribute}(...) -> "
            f"{_annotation(module, kinds)}:`"
        )
    return factory


def _annotation(module: ModuleType, kinds: Sequence[type]) -> str:
    """Return the annotation to advise: a class of the module, or a name in quotes, which needs no
    import."""
    classes = {name: value for name, value in vars(module).items() if isinstance(value, type)}
    fitting = [name for name, value in classes.items() if issubclass(value, tuple(kinds))]
    first = kinds[0].__name__
    return first if first in fitting else next(iter(fitting), f'"{first}"')


def _module(place: str, name: str) -> ModuleType:
    """Import the module at `place`, a file or a name; `name` is what the user calls the system."""
    if place.endswith(".py"):
        root = _file_root(place)
        loader = _FromSource(root.module, str(root.path))
        spec = importlib.util.spec_from_file_location(root.module, root.path, loader=loader)
        if spec is None or root.path is None:
            raise UserError(f"{place!r} cannot be imported: it must be a Python file")
        module = importlib.util.module_from_spec(spec)
        try:
            loader.get_code(root.module)  # before anything of it runs
        except (ValueError, RecursionError, MemoryError) as error:
            raise UserError(f"{place} is not valid Python ({error}): correct it") from error
        _check_own(root.path, root.path.parent)
        sys.modules[root.module] = module  # dataclasses look their module up by name
        loader.exec_module(module)
    else:
        if not _installed(name):
            _look_in(os.getcwd())  # where a console script does not look
            _check_own(place, Path.cwd())
        try:
            module = importlib.import_module(place)
        except ModuleNotFoundError as error:
            if error.name and f"{place}.".startswith(f"{error.name}."):
                raise UserError(
                    f"there is no module {error.name!r}, which {name!r} names: check the name, or "
                    "give the path of the file as 'path/to/file.py:attribute'"
                ) from error
            raise
    if (file := getattr(module, "__file__", None)) and not ours(module.__name__):
        note_system(file)
        keep_digests(Path(os.path.realpath(file)).parent)
    return module


def factory_root(spec: SystemSpec) -> Root:
    """Return the module that builds the system; `UserError` where `load_system` raises one."""
    place, _ = _target(spec.name)
    if place.endswith(".py"):
        return _file_root(place)
    if not _installed(spec.name):
        _look_in(os.getcwd())
    return Root(place)


def _file_root(place: str) -> Root:
    """Return the module of a file, whose neighbours it may import from their sources."""
    path = Path(os.path.realpath(place))
    if not os.path.isfile(path):  # unlike Path.is_file, it bears names that are too long
        raise UserError(f"there is no file {place!r} to load from: check the path")
    _look_in(folder := str(path.parent))
    loaders = ((ExtensionFileLoader, EXTENSION_SUFFIXES), (_FromSource, SOURCE_SUFFIXES))
    sys.path_importer_cache[folder] = FileFinder(folder, *loaders)
    return Root(f"faultpath_system_{path.stem}_{sha256(bytes(path)).hexdigest()[:8]}", path)


def factory_name(name: str) -> str:
    """Return the name of a system with its factory, `create` where a file is named alone."""
    return f"{name}:create" if name.endswith(".py") else name


def _installed(name: str) -> bool:
    return ":" not in name and not name.endswith(".py") and name in installed_systems()


def _target(name: str) -> tuple[str, str]:
    try:
        return _split(factory_name(installed_systems()[name] if _installed(name) else name))
    except UserError:
        known = ", ".join(sorted(installed_systems())) or "none"
        hint = f"did you mean '{name}.py'? " if os.path.isfile(f"{name}.py") else ""
        raise UserError(
            f"there is no system {name!r}; {hint}installed: {known}; install what declares it, "
            "or name a factory as 'module:attribute' or 'path/to/file.py:attribute'"
        ) from None


def _split(name: str) -> tuple[str, str]:
    place, _, attribute = name.rpartition(":")
    relative = place.startswith(".") and not place.endswith(".py")
    if not place or not attribute or relative or "\0" in name:
        raise UserError(
            f"{name!r} names nothing to build: name it as 'module:attribute' or "
            "'path/to/file.py:attribute'"
        )
    return place, attribute


class _FromSource(SourceFileLoader):
    """Compiles what the file holds now, of which the digest is taken: compiled code that Python
    keeps stands for the file's size and its time in whole seconds."""

    def get_code(self, fullname: str) -> CodeType:
        return self.source_to_code(self.get_data(self.path), self.path)


def _check_own(start: Path | str, folder: Path) -> None:
    """Refuse a system that would run another system's module in place of its own.

    It begins with the file, or the module, at `start`; what it imports from `folder` is its own.
    """
    names = imported([start]) if isinstance(start, Path) else {start.partition(".")[0]}
    seen = set[str]()
    while unseen := sorted(names - seen):
        seen.add(name := unseen[0])
        files = (folder / name / "__init__.py", folder / f"{name}.py")
        own = next((file for file in files if file.is_file()), None)
        if own is None or ours(name) or not (origins := package_paths(name)):
            continue
        origin = origins[0] / own.name if origins[0].is_dir() else origins[0]
        if os.path.realpath(own) != os.path.realpath(origin) and kind_of(origin) == "local":
            raise UserError(
                f"{start} imports {name!r}, which is {origin} in this process and not its own "
                f"{own}: rename one of the two, or load them in processes of their own"
            )
        names |= imported(own.parent.rglob("*.py") if own.stem == "__init__" else [own])


@contextmanager
def _loading(name: str) -> Generator[None]:
    """Put back what loading a system changed when it comes to nothing, modules of its own too.

    Where a package is missing, say which one `name` needs.
    """
    path, modules = tuple(sys.path), dict(sys.modules)
    try:
        with set_apart() as before, reads() as opened:
            yield
            if (entered := working_directory()) != before:
                _entered[name] = entered
        _opened.setdefault(_version(name), set()).update(opened)
    except BaseException as error:
        sys.path[:] = path
        for module_name, module in tuple(sys.modules.items()):
            file = getattr(module, "__file__", None)
            if module is modules.get(module_name) or not file or ours(module_name):
                continue
            if kind_of(Path(file)) == "local":
                del sys.modules[module_name]
                if module_name in modules:
                    sys.modules[module_name] = modules[module_name]
        if not isinstance(error, ModuleNotFoundError):
            raise
        package = (error.name or "").partition(".")[0]
        if package == "faultpath":  # a module of ours that there is not
            raise
        hint = extra(package) if package in _EXTRAS else f"install {package!r}"
        mistake = SystemMistake(
            f"{name!r} needs the package {package!r}, not installed here: {hint}"
        )
        mistake.location = where(error)
        raise mistake from error


def _look_in(folder: str) -> None:
    if folder not in sys.path:
        sys.path.append(folder)
