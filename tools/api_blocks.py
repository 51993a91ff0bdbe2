"""Names of a module and what their calls take, for who reads one page and no site."""

import inspect
import re
from importlib import import_module
from typing import Any


def signatures(module: str, *names: str) -> str:
    """Return names of a module, by default all of `__all__`, each with what it takes and does."""
    home = import_module(module)
    shown = names or sorted(name for name in home.__all__ if not name.startswith("__"))
    lines = "\n".join(_line(name, getattr(home, name)) for name in shown)
    return f"```text\n{lines}\n```"


def _line(name: str, thing: Any) -> str:
    doc = inspect.getdoc(thing) or ""
    first = " ".join(re.split(r"(?<=\.)\s|\n\n", doc, maxsplit=1)[0].split())
    try:
        parameters = inspect.signature(thing).parameters.values()
    except (TypeError, ValueError):
        return f"{name}\n    {first}"
    fields = [field.replace(annotation=field.empty) for field in parameters]
    if inspect.isclass(thing) and any(field.name.startswith("_") for field in fields):
        fields = []  # only faultpath makes one
    return f"{name}{inspect.Signature(fields)}\n    {first}"
