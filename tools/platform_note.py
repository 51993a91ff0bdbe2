"""Write the tables of `docs/design/platform.md` from the records of the platform search.

python tools/platform_note.py [--freeze]
"""

import argparse
import json
import re
from pathlib import Path

from faultpath.quadrotor.platform import platform, platform_hash

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


def frozen(name: str) -> str:
    """Return a frozen planner and wind levels as a Markdown table."""
    record = json.loads((RECORDS / f"{name}.json").read_text())
    planner, wind = record["platform"]["planner"], record["platform"]["wind"]
    parts = {
        "sampler": planner["sampler"],
        "terminal cost": planner["terminal"],
        "running cost": planner["running"],
        "temperature": {"fraction of the spread": planner["temperature"]},
        "mean wind, m/s": {name: level["mean_mps"] for name, level in wind.items()},
    }
    if "perception" in record["platform"]:
        parts["perception"] = record["platform"]["perception"]
    lines = ["| frozen | settings |", "|---|---|"]
    for name, values in parts.items():
        shown = ", ".join(f"{key} {value}" for key, value in values.items())
        lines.append(f"| {name} | {shown} |")
    return "\n".join([*lines, "", f"Hash `{record['hash']}`."])


def main() -> None:
    """Fill every `<!-- begin:NAME -->` block that names a record."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--freeze", action="store_true", help="freeze what the code says now")
    if parser.parse_args().freeze:
        now = {"hash": platform_hash(), "platform": platform()}
        (RECORDS / "frozen.json").write_text(json.dumps(now, indent=1) + "\n")
    text = NOTE.read_text()
    for record in sorted(RECORDS.glob("*.json")):
        made = (frozen if record.stem.startswith("frozen") else table)(record.stem)
        block = re.compile(
            rf"(<!-- begin:{record.stem} -->\n).*?(<!-- end:{record.stem} -->)", re.S
        )
        text = block.sub(lambda m, made=made: m[1] + made + "\n" + m[2], text)
    NOTE.write_text(text)


if __name__ == "__main__":
    main()
