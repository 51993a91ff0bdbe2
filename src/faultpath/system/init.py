"""New systems from templates: a file that runs as it is, and its test."""

import re
import sys
from importlib.resources import files
from importlib.util import find_spec
from keyword import iskeyword
from pathlib import Path

from faultpath.core.errors import UserError
from faultpath.core.files.atomic import write_text

TEMPLATES = {
    "numpy": ("calibrated", "gain"),
    "torch": ("calibrated", "gain"),
    "gymnasium": ("known", "mass"),
}
"""By library that the system is written with: its baseline, and the channel to fault."""


def write_system(name: str, kind: str, folder: Path) -> tuple[Path, Path]:
    """Write `NAME.py` and `test_NAME.py` into a folder and return their paths.

    Raises `UserError` for a name that is no Python name, has a meaning to Python or pytest or
    already belongs to another module, for an unknown template, and for files that exist.
    """
    plain = re.fullmatch(r"[a-z][a-z0-9_]*", name)  # as names of systems are
    if not plain or name.startswith("test_") or name.endswith("_test"):
        raise UserError(
            f"{name!r} cannot name a system and its file: take small letters, digits and '_', such "
            "as my_rover."
        )
    spec = None if iskeyword(name) else find_spec(name)
    paths = [] if spec is None else [*(spec.submodule_search_locations or ()), spec.origin]
    local = all(Path(path).resolve().is_relative_to(folder.resolve()) for path in paths if path)
    taken = ""
    if iskeyword(name):
        taken = "a word of Python"
    elif name in ("conftest", "setup", "sitecustomize", "usercustomize"):
        taken = "a file of Python's or pytest's own"
    elif name in sys.stdlib_module_names:
        taken = "a module of Python's own"
    elif paths and ("site-packages" in str(paths) or not local):
        taken = "an installed package"
    if taken:
        raise UserError(
            f"{name!r} is {taken}, which a file {name}.py would stand before: choose another name, "
            f"such as my_{name}."
        )
    if kind not in TEMPLATES:
        raise UserError(f"there is no template {kind!r}: choose from {', '.join(TEMPLATES)}.")
    (baseline, parameter), texts = TEMPLATES[kind], files("faultpath.system") / "templates"
    system = (texts / f"{kind}.py.txt").read_text("utf-8").replace("NAME", name)
    test = (texts / "test.py.txt").read_text("utf-8").replace("NAME", name)
    test = test.replace("BASELINE", f'"{baseline}"').replace("PARAMETER", parameter)
    files_to_write = folder / f"{name}.py", folder / f"test_{name}.py"
    for path in files_to_write:
        if path.exists():
            raise UserError(f"{path} is there already: choose another name, or move it away.")
    try:
        for path, text in zip(files_to_write, (system, test), strict=True):
            write_text(path, text)
    except BaseException:
        for path in files_to_write:
            path.unlink(missing_ok=True)
        raise
    return files_to_write
