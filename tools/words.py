"""Count words that the project does not use, and fail where there are more than there were.

    python tools/words.py               compare with the numbers in tools/words.json
    python tools/words.py --list        print each place, and what to write instead
    python tools/words.py --files       print how many places each file has
    python tools/words.py --lower       write the numbers of today, where they are lower

Local names are nouns of what they hold, and docstrings begin with a verb or the noun itself. Texts
that code shows, and pages that users read, do without the words of `HOUSE`.
"""

import argparse
import ast
import json
import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
MOST = ROOT / "tools" / "words.json"
ROOMS = ("src", "quadrotor/src", "paper/src", "tools", "benchmarks", "examples")
SHOWING = ROOMS[:3]
NAMES = {"each", "found", "asked", "given", "held", "said", "told", "made", "wanted", "now"}
OPENINGS = ("What", "Of")

HOUSE = {
    "arm": (r"arms?", "variant, version; baseline, repair"),
    "consumer": (r"consumers?", "module, reader"),
    "strike": (r"struck|strik(?:e|es|ing)", "reach"),
    # Logs are of recorded or real flights, whoever reads them.
    "flight": (r"flown|(?<!real )(?<!recorded )flights?|fl(?:y|ies|ew|ying)", "trial; run"),
    # `all-decided` is the value of an option; a detectable difference is the term of statistics.
    "decide": (r"(?<!all-)decide[sd]?|undecided", "significant; inconclusive"),
    "detect": (r"detect(?:s|ed)?|announce[sd]?", "significant"),
    # To record is also a verb.
    "record": (r"(?:the|a|an|no|every|each|this|its|and|decision) records?(?!\.json)", "result"),
    "verdict": (r"verdicts?|judge?ments?|receipts?", "result; delivery log"),
    "tap": (r"tap(?:s|ped|ping)?", "injection point"),
    "tell": (r"told|hears?|heard|hearing|tells of", "replay; what is meant"),
    # Files and compiled code have paths too: those are counted with the others.
    "path": (r"paths?", "condition; where the fault acts"),
}
"""Words that users do not meet, by their pattern, and what to write instead."""
FIELD = {
    "arm": r"lerobot\.md",
    "flight": r"(?:quadrotor|paper)/|docs/(?:quadrotor|state-errors|rotorpy"
    r"|basilisk|reproduction|carry-over|reversal-map|bring-your-own-model)",
}
"""Files on robots, aircraft and spacecraft, by the word that has its plain meaning there."""
HOUSE_WORD = re.compile(
    "|".join(rf"\b(?P<{word}>{pattern})\b" for word, (pattern, _) in HOUSE.items()), re.IGNORECASE
)
NO_PROSE = re.compile(
    r"^<!-- begin:(?P<block>\S+) -->$.*?^<!-- end:(?P=block) -->$"
    r"|^(?P<indent> *)```.*?^(?P=indent)```|`[^`\n]*(?:\n[^`\n]+)?`|\]\([^)\n]*\)",
    re.MULTILINE | re.DOTALL,
)
"""Generated blocks, code, and the targets of links."""


class Place(NamedTuple):
    """A place that counts."""

    file: str
    line: int
    kind: str
    word: str


def words_in_prose(text: str, file: str, line: int, kind: str) -> Iterator[Place]:
    """Yield the house words of a text that begins at a line of a file."""
    prose = NO_PROSE.sub(lambda match: re.sub(r"[^\n]", "-", match[0]), text)
    for match in HOUSE_WORD.finditer(prose):
        word = match.lastgroup or ""
        if word not in FIELD or not re.search(FIELD[word], file):
            at = line + prose.count("\n", 0, match.start())
            yield Place(file, at, kind, f"{' '.join(match[0].split())} -> {HOUSE[word][1]}")


def words_in_code(text: str, file: str) -> Iterator[Place]:
    """Yield local names, openings of docstrings and words of shown texts that count."""
    docstrings: set[ast.Constant] = set()
    shown = file.startswith(SHOWING)
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id in NAMES:
            yield Place(file, node.lineno, "names", node.id)
        elif isinstance(node, ast.arg) and node.arg in NAMES:
            yield Place(file, node.lineno, "names", node.arg)
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            docstrings.add(node.value)
            word = str(node.value.value).strip().partition(" ")[0]
            if word in OPENINGS:
                yield Place(file, node.lineno, "docstrings", word)
        elif isinstance(node, ast.Constant) and shown and node not in docstrings:
            text = node.value if isinstance(node.value, str) else ""
            if " " in text:
                yield from words_in_prose(text, file, node.lineno, "texts")


def places() -> Iterator[Place]:
    """Yield all that counts, file by file."""
    for code in (path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py"))):
        yield from words_in_code(code.read_text("utf-8"), code.relative_to(ROOT).as_posix())
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))):
        file = page.relative_to(ROOT).as_posix()
        yield from words_in_prose(page.read_text("utf-8"), file, 1, "pages")


def main() -> int:
    """Compare the counts with the most that there may be; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    for option in ("list", "files", "lower"):
        parser.add_argument(f"--{option}", action="store_true")
    options = parser.parse_args()
    counted = list(places())
    counts = Counter(place.kind for place in counted)
    if options.list:
        for place in counted:
            print(f"{place.file}:{place.line}: {place.word} ({place.kind})")
    if options.files:
        for file, count in Counter(place.file for place in counted).most_common():
            print(f"{count:5} {file}")
    most: dict[str, int] = json.loads(MOST.read_text("utf-8"))
    if options.lower:
        most = {kind: min(number, counts[kind]) for kind, number in most.items()}
        MOST.write_text(json.dumps(most) + "\n", "utf-8")
    for kind, number in most.items():
        print(f"{kind}: {counts[kind]}, at most {number}")
    if more := [kind for kind, number in most.items() if counts[kind] > number]:
        print(f"More {' and '.join(more)} than before: --list says where, and what to write.")
    return bool(more)


if __name__ == "__main__":
    sys.exit(main())
