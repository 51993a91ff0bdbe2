"""Public names of a package, each loaded from its module when it is first used."""

import random
import sys
from collections.abc import Mapping
from importlib import import_module


def load(package: str, homes: Mapping[str, str], name: str) -> object:
    """Return what a name of a package stands for, and keep it there.

    `AttributeError` for a name that is none of `homes`, which says the module of each.
    """
    if name not in homes:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    drawn = random.getstate()
    try:
        value = getattr(import_module(homes[name]), name)
    finally:
        random.setstate(drawn)  # some libraries draw from it when they are imported
    vars(sys.modules[package])[name] = value
    return value
