"""Names of a module with their signatures, for who reads one page and no site."""

import inspect
import re
from importlib import import_module

_PATH = re.compile(r"\b(?:[a-z_]\w*\.)+(?=\w)")
_NOTES = re.compile(r"Annotated\[(\w+),[^\]]*\]")


def signatures(module: str, *names: str) -> str:
    """Return names of a module, by default all of `__all__`, each with what it takes and does."""
    home = import_module(module)
    shown = names or sorted(name for name in home.__all__ if not name.startswith("__"))
    lines = "\n".join(_line(name, getattr(home, name)) for name in shown)
    return f"```text\n{lines}\n```"


def _line(name: str, thing: object) -> str:
    doc = inspect.getdoc(thing) or ""
    first = " ".join(re.split(r"(?<=\.)\s|\n\n", doc, maxsplit=1)[0].split())
    try:
        taken = str(inspect.signature(thing))  # pyright: ignore[reportArgumentType]
    except (TypeError, ValueError):
        taken = ""
    if inspect.isclass(thing):
        taken = taken.removesuffix(" -> None")
        if re.search(r"[(\s]_\w+:", taken):  # only faultpath makes one
            taken = ""
    taken = _NOTES.sub(r"\1", _PATH.sub("", taken))
    return f"{name}{taken}\n    {first}"
