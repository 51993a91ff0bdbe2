"""The tables of `docs/design/platform.md`, from the records of the platform search."""

import json

from blocks import ROOT, Wrong

from faultpath.quadrotor.platform import platform, platform_hash
from faultpath.tables import MISSING, Table, line
from faultpath.tables.markdown import grid

RECORDS = ROOT / "docs" / "design" / "platform-search"


def fill(name: str) -> str:
    """Return one record as a table."""
    path = RECORDS / f"{name}.json"
    if not path.is_file():
        raise Wrong(f"there is no record {path.relative_to(ROOT)}")
    record = json.loads(path.read_text("utf-8"))
    return frozen(record) if "hash" in record else searched(record)


def freeze() -> None:
    """Make what the code says now the frozen platform."""
    now = {"hash": platform_hash(), "platform": platform()}
    (RECORDS / "frozen.json").write_text(json.dumps(now, indent=1) + "\n", "utf-8")


def searched(results: list[dict]) -> str:
    """Return the counts of a search: a row a setting, a column a cell."""
    cells = list(dict.fromkeys(r["cell"] for r in results))
    keys = list(dict.fromkeys(key for r in results for key in r["point"]))
    rows: dict[tuple, dict[str, str]] = {}
    for r in results:
        point = (r["planner"], *(str(r["point"].get(key, MISSING)) for key in keys))
        rows.setdefault(point, {})[r["cell"]] = _counts(r)
    lines = (
        line(point[0], *point[1:], *(found.get(cell, "") for cell in cells))
        for point, found in rows.items()
    )
    table = Table(corner="planner", columns=(*keys, *cells), lines=tuple(lines))
    scenes = " or ".join(str(n) for n in sorted({r["scenes"] for r in results}))
    return (
        f"{grid(table)}\n\nSuccess / crash / timeout in {scenes} selection scenes; in brackets "
        "the median time of a success, s."
    )


def _counts(result: dict) -> str:
    time = result["median_time_s"]
    counts = f"{result['success']} / {result['crash']} / {result['timeout']}"
    return counts if time is None else f"{counts} ({time:.2f})"


def frozen(record: dict) -> str:
    """Return a frozen planner and wind levels."""
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
    lines = (
        line(name, ", ".join(f"{key} {value}" for key, value in values.items()))
        for name, values in parts.items()
    )
    heads = ("settings",)
    table = Table(corner="frozen", columns=heads, words=heads, lines=tuple(lines))
    return f"{grid(table)}\n\nHash `{record['hash']}`."
