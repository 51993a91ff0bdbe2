"""Public names of a package, loaded from their modules on first use."""

import random
import sys
from collections.abc import Mapping
from importlib import import_module


def load(package: str, homes: Mapping[str, str], name: str) -> object:
    """Return the object of a public name, and set it as the package's attribute.

    `homes` gives the module of each name; `AttributeError` for any other name.
    """
    if name not in homes:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    state = random.getstate()
    try:
        value = getattr(import_module(homes[name]), name)
    finally:
        random.setstate(state)  # some libraries draw from it when they are imported
    vars(sys.modules[package])[name] = value
    return value
