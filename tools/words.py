"""Count words that the project does not use, and fail where there are more than there were.

Local names are nouns of what they hold, and docstrings begin with a verb or the noun itself.
"""

import ast
import json
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
MOST = json.loads((ROOT / "tools" / "words.json").read_text("utf-8"))
ROOMS = ("src", "quadrotor/src", "paper/src", "tools", "benchmarks")
NAMES = {"each", "found", "asked", "given", "held", "said", "told", "made", "wanted", "now"}
OPENINGS = ("What", "Of")


def occurrences(path: Path) -> Iterator[tuple[str, int, str]]:
    """Yield kind, line and word of each local name and docstring of a file that counts."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id in NAMES:
            yield "names", node.lineno, node.id
        elif isinstance(node, ast.arg) and node.arg in NAMES:
            yield "names", node.lineno, node.arg
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            text = node.value.value
            word = text.split(maxsplit=1)[0] if isinstance(text, str) and text.strip() else ""
            if word in OPENINGS:
                yield "docstrings", node.lineno, word


def main() -> int:
    """Compare the counts with the most that there may be; return the exit status."""
    places: dict[str, list[str]] = {kind: [] for kind in MOST}
    for path in (path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py"))):
        for kind, number, word in occurrences(path):
            places[kind].append(f"{path.relative_to(ROOT)}:{number}: {word}")
    status = 0
    for kind, most in MOST.items():
        print(f"{kind}: {len(places[kind])}, at most {most}")
        if len(places[kind]) > most:
            print(*places[kind], f"Name what is held, not {', '.join(sorted(NAMES))}.", sep="\n")
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
