"""Count words that the project does not use, and fail where there are more than there were.

    python tools/words.py               compare with the numbers in tools/words.json
    python tools/words.py --files       list the files that have most of them
    python tools/words.py --lower       write the numbers of today, where they are lower

Local names are nouns of what they hold, and docstrings begin with a verb or the noun itself.
"""

import argparse
import ast
import json
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
MOST = ROOT / "tools" / "words.json"
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
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--files", action="store_true", help="list files with their counts")
    parser.add_argument("--lower", action="store_true", help="write lower numbers")
    options = parser.parse_args()
    places = [
        (path.relative_to(ROOT), *occurrence)
        for room in ROOMS
        for path in sorted((ROOT / room).rglob("*.py"))
        for occurrence in occurrences(path)
    ]
    counts = Counter(kind for _, kind, _, _ in places)
    if options.files:
        for path, count in Counter(path for path, *_ in places).most_common():
            print(f"{count:5} {path}")
    most: dict[str, int] = json.loads(MOST.read_text("utf-8"))
    if options.lower:
        most = {kind: min(number, counts[kind]) for kind, number in most.items()}
        MOST.write_text(json.dumps(most) + "\n", "utf-8")
    for kind, number in most.items():
        print(f"{kind}: {counts[kind]}, at most {number}")
    if more := [kind for kind, number in most.items() if counts[kind] > number]:
        words = ", ".join(sorted(NAMES))
        print(f"More {' and '.join(more)} than before: name what is held, not {words}.")
    return bool(more)


if __name__ == "__main__":
    sys.exit(main())
