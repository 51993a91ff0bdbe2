"""Sections of the page of `make statistics`: how a table is written, kept and read again."""

from collections.abc import Callable, Iterable
from hashlib import sha256
from pathlib import Path
from typing import TypeAlias

import faultpath
from faultpath.core.files.atomic import write_file

Section: TypeAlias = tuple[str, Callable[[], str]]
"""Title and what measures the table; `simulation_notes.yaml` says what that is."""


def share(rates: Iterable[float]) -> str:
    """Return `.950`, or the least and the greatest of several rates."""
    texts = [f"{r:.3f}".removeprefix("0") if r < 0.9995 else "1" for r in sorted(rates)]
    return texts[0] if texts[0] == texts[-1] else f"{texts[0]}–{texts[-1]}"


def markdown(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a Markdown table."""
    lines = [list(heads), *map(list, rows)]
    lines.insert(1, [":--", *["--:"] * (len(lines[0]) - 1)])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def merged(rows: Iterable[tuple[str, Iterable[float]]]) -> list[list[str]]:
    """Return lines of a table: rows of one name are one line, with the range of each rate."""
    lines: dict[str, list[Iterable[float]]] = {}
    for name, rates in rows:
        lines.setdefault(name, []).append(rates)
    return [[name, *map(share, zip(*rates, strict=True))] for name, rates in lines.items()]


def kept(title: str, measured: Callable[[], str]) -> str:
    """Return a table, from `build/statistics` where the same code has measured it before."""
    package = Path(faultpath.__file__).parent
    rooms = (package / "stats", package / "analyses")
    files = [file for room in rooms for file in room.rglob("*.py")]
    files += Path(__file__).parent.glob("simulation*.py")
    code = sha256(b"".join(file.read_bytes() for file in sorted(files))).hexdigest()[:16]
    path = Path("build/statistics") / code / f"{title}.md"
    if not path.is_file():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_file(path, measured().encode())
    return path.read_text("utf-8")


def written(page: Path) -> dict[str, str]:
    """Return the sections of a page as they are, by their titles."""
    parts = page.read_text("utf-8").rstrip().split("\n\n## ")[1:]
    return {part.split("\n", 1)[0]: f"## {part}" for part in parts}
