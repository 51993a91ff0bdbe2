"""Checks of the arguments of systems and plants.

Each function raises `SystemMistake` with a sentence that says what is wrong and what to give.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from inspect import signature
from math import isfinite
from numbers import Integral, Real
from operator import index
from typing import Any, cast

import numpy as np

from faultpath.core.error_source import mistake_in
from faultpath.core.errors import SystemMistake
from faultpath.core.text import ADDRESS, counted
from faultpath.loop import Module, Plant
from faultpath.system import declared
from faultpath.system.outcome import Metric


def seeds_of(scenes: Any) -> dict[str, tuple[int, ...]]:
    """Return the seeds of each library of scenes."""
    example = "such as {'training': range(20)}"
    libraries: dict[str, tuple[int, ...]] = {}
    for library, seeds in _mapping("scenes", scenes, example).items():
        try:
            libraries[library] = tuple(map(index, seeds))
        except TypeError:
            raise SystemMistake(
                f"scenes: library '{library}' is {shown(seeds)}: give the seeds of its scenes, "
                "whole numbers, such as range(20)"
            ) from None
        if not libraries[library]:
            raise SystemMistake(f"scenes: library '{library}' is empty: give at least one seed")
    return libraries


def modules_of(variant: str, modules: Any) -> Sequence[Module]:
    """Return the modules of a variant."""
    where = f"variant '{variant}'"
    if not isinstance(modules, Sequence):
        raise SystemMistake(f"{where} is {shown(modules)}: give a list of modules")
    for module in cast("Sequence[Any]", modules):
        if isinstance(module, Module):
            continue
        kind = f"the function {module.__name__}" if hasattr(module, "__name__") else shown(module)
        raise SystemMistake(
            f"{where} holds {kind}, which is not a module: write @writes('what it writes') above "
            "its def"
        )
    return cast("Sequence[Module]", modules)


def invalid_name(module: Module) -> str | None:
    """Return a name of a module, its places or channels that an interface cannot have."""
    names = (n for port in module.ports for n in (port.channel, *module.reader(port).split(".")))
    return next((name for name in names if not re.fullmatch(r"[a-z][a-z0-9_]*", name)), None)


def plant_of(plant: Any) -> Plant:
    """Return the plant of a system."""
    if not isinstance(plant, Plant):
        raise SystemMistake(f"`plant` returned {shown(plant)}: return a Plant")
    return plant


def variants_of(variants: Any) -> Mapping[str, Any]:
    """Return the variants."""
    return _mapping("variants", variants, "such as {'old': [filter, controller]}")


def units_of(units: Any) -> Mapping[str, Any]:
    """Return the units, or other fields, of each source."""
    for source, entry in _mapping("units", units, "such as {'speed': 'm/s'}").items():
        if not isinstance(entry, str | Mapping):
            raise SystemMistake(
                f"units: source '{source}' has {shown(entry)}: give its unit as text, '1' for a "
                "number without one, or fields by name"
            )
    return units


def channels_of(channels: Any) -> dict[str, tuple[str, ...]]:
    """Return the sources of each channel with several of them."""
    example = "such as {'speed': ['wheels', 'filter']}"
    checked: dict[str, tuple[str, ...]] = {}
    for channel, sources in _mapping("channels", channels, example).items():
        if isinstance(sources, str) or not isinstance(sources, Sequence) or not sources:
            raise SystemMistake(
                f"channels: '{channel}' is {shown(sources)}: give a list of its sources"
            )
        checked[channel] = tuple(cast("Sequence[str]", sources))
    return checked


def check_episode(steps: Any, dt_s: Any, succeeded: Any, metrics: Any) -> None:
    """Check the length of an episode and of a step, and the measures of an episode."""
    if not isinstance(steps, Integral) or steps < 1:
        raise SystemMistake(f"steps is {shown(steps)}: give a whole number of at least 1")
    if not isinstance(dt_s, Real) or not isfinite(dt_s) or dt_s <= 0:
        raise SystemMistake(f"dt_s is {shown(dt_s)}: give the seconds of a step, above 0")
    if not callable(succeeded):
        raise SystemMistake(f"succeeded is {shown(succeeded)}: give a function of an episode")
    for name, measure in _mapping("metrics", metrics, "such as {'missed_m': Measure(…)}").items():
        if not isinstance(getattr(measure, "metric", None), Metric):
            raise SystemMistake(
                f"metrics: '{name}' is {shown(measure)}: give a Measure, such as "
                "Measure(Metric(unit='m', better='less'), function)"
            )


def check_call(name: str, function: Any, arguments: str) -> None:
    """Raise `SystemMistake` unless a function takes these arguments, comma-separated names."""
    if not callable(function):
        raise SystemMistake(f"{name} is {shown(function)}: give a function")
    names = arguments.split(", ")
    try:
        accepted = signature(function)
    except ValueError:  # built-ins such as `dict` have none
        return
    try:
        accepted.bind(*names)
    except TypeError:
        raise mistake_in(
            function,
            f"`{name}` takes {accepted}, but it is called as {name}({arguments}): give it "
            f"{counted(len(names), 'argument')}",
        ) from None


def boolean_of(name: str, function: Callable[..., Any], value: Any, of: str) -> bool:
    """Return a function's result; `SystemMistake` where it is neither true nor false."""
    if type(value) not in (bool, np.bool_):
        raise mistake_in(
            function, f"`{name}` returned {shown(value)} of {of}: it must return true or false"
        )
    return bool(value)


def number_of(name: str, function: Callable[..., Any], value: Any) -> float:
    """Return the value of a metric; `SystemMistake` where it is not a number."""
    try:
        return float(value)
    except (TypeError, ValueError):
        raise mistake_in(
            function, f"metric '{name}' is {shown(value)} of an episode: it must be a number"
        ) from None


def _mapping(name: str, value: Any, example: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise SystemMistake(f"{name} is {shown(value)}: give a mapping by name, {example}")
    return cast("Mapping[str, Any]", value)


def shown(value: Any) -> str:
    """Return a wrong value in one line, without its address in memory."""
    return re.sub(ADDRESS, "", declared.shown(value))
