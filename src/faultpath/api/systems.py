"""A system from whatever names it: a name, a file, or the object itself."""

import os
import re
import shlex
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import cast

from faultpath.core.errors import UserError
from faultpath.core.text import extra, one_line
from faultpath.run import registry
from faultpath.run.plan import SystemSpec
from faultpath.run.registry import factory_name, installed_systems
from faultpath.run.work.executor import Executor
from faultpath.run.work.processes import local
from faultpath.system.checks import check_system
from faultpath.system.options import as_text
from faultpath.system.system import System

LOCAL, RAY = "local", "ray"
"""Where trials run."""

_BRING = "bring"
"""The option of a system that takes parts of the user's own, separated by commas; a system without
it takes no parts."""

_PART = re.compile(r"([^:]+:[A-Za-z_]\w*)(?:/|$)")
"""A part of the user's own, in the name of a variant or in an option."""

_LOADED = "_faultpath_loaded"
"""Under which name an object keeps what it was loaded from."""


@dataclass(frozen=True)
class Chosen:
    """A system, and how it is named."""

    system: System
    spec: SystemSpec
    own: bool = False
    """Whether it is an object of the caller's: nothing but this process has it."""


def load_system(
    system: str | PathLike[str], *, options: Mapping[str, object] | None = None
) -> System:
    """Build a system: what it reads, its variants, its libraries of scenes, to look at or to audit.

    `system` is a name, `module:attribute`, `file.py:attribute`, or a file in which `create` builds
    it; `options` are its own, such as `{"wind": "L3"}`. Raises `UserError` for a name or an option
    that does not exist, and for a package that is missing.
    """
    spec = _spec(system, options or {})
    built = registry.load_system(spec)
    vars(built)[_LOADED] = spec, dict(vars(built))
    return built


def choose(
    system: str | PathLike[str] | System,
    options: Mapping[str, object],
    workers: int | None,
    variants: Sequence[str],
    executor: str = LOCAL,
) -> Chosen:
    """Return the system to audit, with the parts that its variants name.

    What `load_system` gave is built again from its name and options, unless somebody changed its
    attributes. Raises as `load_system`, and for what an object cannot do and an executor that there
    is not.
    """
    check_executor(executor)
    if not isinstance(system, System):
        spec = _spec(system, options)
    elif options:
        raise UserError(
            "options build a system, and this one is built: give its name with the options, or "
            "give them to load_system."
        )
    else:
        spec, before = vars(system).get(_LOADED, (None, {}))
        current = {name: value for name, value in vars(system).items() if name != _LOADED}
        same = all(name in current and current[name] is value for name, value in before.items())
        more = [getattr(type(system), name, None) for name in current if name not in before]
        if not same or not all(isinstance(attribute, cached_property) for attribute in more):
            spec = None
    if spec is not None:
        spec = with_parts(spec, variants)
        return Chosen(registry.load_system(spec), spec)
    if workers or executor != LOCAL:
        idle = "workers" if workers else "executor"
        raise UserError(
            "an object cannot be sent to worker processes: put what builds the system into a file "
            f"and name that, as 'my_system.py:create', or leave {idle} out."
        )
    assert isinstance(system, System)
    spec = SystemSpec.of_class(type(system))
    check_system(system, spec.name)
    return Chosen(system, spec, own=True)


def check_executor(executor: object) -> None:
    """Raise `UserError` for what names no executor."""
    if executor not in (LOCAL, RAY) and not str(executor).startswith(f"{RAY}:"):
        raise UserError(
            f"there is no executor {executor!r:.80}: use 'local', 'ray', or 'ray:HOST:PORT' with "
            "the address of a cluster's head."
        )


def executor_of(system: System, workers: int | None, executor: str = LOCAL) -> Executor:
    """Return what runs trials: processes of this machine, or the workers of a Ray cluster.

    Where `workers` is left out, one for each core or CPU if the system gains by several. Raises
    `UserError` for an executor that cannot be used.
    """
    count = 1 if workers is None and not system.parallel else workers
    if executor == LOCAL:
        return local((os.cpu_count() or 1) if count is None else count)
    try:
        from faultpath.run.work.ray_cluster import RayWorkers
    except ModuleNotFoundError as error:
        raise UserError(
            f"--executor ray needs the package {error.name!r}, not installed here: {extra('ray')}"
        ) from None
    return RayWorkers(executor.removeprefix(RAY).removeprefix(":"), count)


def with_parts(spec: SystemSpec, variants: Sequence[str]) -> SystemSpec:
    """Return a system with the parts of the user's own that `variants` name among its options.

    So worker processes, fingerprint and record get them as they get every option. A variant is
    named by a part, or by a part and more after a slash, as in `my_model.py:create/gru`.
    `UserError` for a file without the name of what builds the part, or a comma in its path.
    """
    named = [name for name in variants if ":" in name or name.endswith(".py")]
    if not named or _BRING not in {option.name for option in registry.system_options(spec.name)}:
        return spec
    parts = [part for part in spec.options.get(_BRING, "").split(",") if part]
    for name in named:
        if ":" not in name:
            raise UserError(
                f"'{name}' is a file: name the function in it that builds your part too, as in "
                f"'{name}:create'."
            )
        if "," in name:
            raise UserError(f"'{name}' has a comma in it: rename the file, commas part names.")
        parts += _PART.findall(name)
    options = {**spec.options, _BRING: ",".join(dict.fromkeys(parts))}
    return SystemSpec(name=spec.name, options=options)


def _spec(system: object, options: Mapping[str, object]) -> SystemSpec:
    if not isinstance(system, str | PathLike):
        raise UserError(
            f"a system is a name, a file or a faultpath.System, not {system!r:.80}: name one as "
            "'quadrotor' or 'my_system.py:create'."
        )
    name = os.fspath(cast("str | PathLike[str]", system))
    return SystemSpec(name=factory_name(name), options=as_text(options))


def check_named(
    file: str, spec: SystemSpec, variants: Sequence[str], named: Collection[str], trusted: bool
) -> None:
    """Raise `UserError` where building `spec`, which `file` describes, would import code that is
    not installed and that the person has not `named` too, unless everything is `trusted`."""
    again = {*named, *map(factory_name, named)}
    unnamed = [one_line(name) for name in _names(spec, variants) if name not in again]
    if unnamed and not trusted:
        raise UserError(
            f"{file} names {', '.join(unnamed)}, and importing that runs it: look at it first, "
            f"then run the command with {' '.join(f'--code {shlex.quote(of)}' for of in unnamed)}, "
            "or give --trust"
        )


def _names(spec: SystemSpec, variants: Sequence[str]) -> Iterator[str]:
    """Yield what names code that is not installed: the system, then whatever may name a part.

    How a system reads its options is its own affair, so each that could name code counts whole.
    """
    if spec.name not in installed_systems():
        yield spec.name
    pieces = [piece.strip() for value in spec.options.values() for piece in value.split(",")]
    pieces += [name for variant in variants for name in _PART.findall(variant)]
    yield from dict.fromkeys(piece for piece in pieces if ":" in piece or ".py" in piece)
