"""Write the tables of `docs/design/platform.md` from the records of the platform search.

python tools/platform_note.py
"""

import json
import re
from pathlib import Path

NOTE = Path(__file__).parents[1] / "docs/design/platform.md"
RECORDS = NOTE.parent / "platform-search"


def table(name: str) -> str:
    """Return one record as a Markdown table: a row a setting, a column a cell."""
    results = json.loads((RECORDS / f"{name}.json").read_text())
    cells = list(dict.fromkeys(r["cell"] for r in results))
    keys = list(dict.fromkeys(key for r in results for key in r["point"]))
    rows: dict[tuple, dict[str, dict]] = {}
    for r in results:
        point = (r["planner"], *(r["point"].get(key, "–") for key in keys))
        rows.setdefault(point, {})[r["cell"]] = r
    head = ["planner", *keys, *cells]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for point, found in rows.items():
        shown = [_cell(found.get(cell)) for cell in cells]
        lines.append("| " + " | ".join([*map(str, point), *shown]) + " |")
    scenes = sorted({r["scenes"] for r in results})
    note = f"Success / crash / timeout in {' or '.join(map(str, scenes))} selection scenes"
    return "\n".join([*lines, "", f"{note}; in brackets the median time of a success, s."])


def _cell(result: dict | None) -> str:
    if result is None:
        return ""
    time = result["median_time_s"]
    counts = f"{result['success']} / {result['crash']} / {result['timeout']}"
    return counts if time is None else f"{counts} ({time:.2f})"


def main() -> None:
    """Fill every `<!-- begin:NAME -->` block that names a record."""
    text = NOTE.read_text()
    for record in sorted(RECORDS.glob("*.json")):
        block = re.compile(
            rf"(<!-- begin:{record.stem} -->\n).*?(<!-- end:{record.stem} -->)", re.S
        )
        text = block.sub(lambda m, name=record.stem: m[1] + table(name) + "\n" + m[2], text)
    NOTE.write_text(text)


if __name__ == "__main__":
    main()
