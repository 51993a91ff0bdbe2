"""Systems in files, for what a command or a worker imports."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HEAD = f"""import sys
sys.path += [{str(ROOT / "examples")!r}, {str(Path(__file__).parent)!r}]
from dataclasses import replace
from pathlib import Path
import numpy as np
from faultpath.system import Library, SceneRef, System, Variant
"""
CREATE = "def create(**options) -> Mine: return Mine(**options)"


def written(
    folder: Path,
    body: str = "pass",
    base: str = "toy.Toy",
    create: str = CREATE,
    file: str = "mine.py",
) -> str:
    """Write a system with this body of a class and return its name.

    It is one of `base`: the example's toy, or a toy beside this file.
    """
    module, kind = base.split(".")
    lines = [f"import {module}", f"from {module} import {kind}"]
    lines += [f"class Mine({kind}):", *(f"    {line}" for line in body.splitlines()), create]
    (folder / file).write_text(HEAD + "\n".join(lines) + "\n", "utf-8")
    return f"{folder / file}:create"
