"""The tables of `docs/design/platform.md`, from the records of the platform search."""

import json
from operator import itemgetter

import platform_tables
from blocks import ROOT, Wrong, tabled

from faultpath.quadrotor.platforms import PLATFORMS
from faultpath.tables import MISSING

RECORDS = ROOT / "docs" / "design" / "platform-search"


def fill(name: str, part: str = "") -> str:
    """Return one record, or a part of it, as a table."""
    path = RECORDS / f"{name}.json"
    if not path.is_file():
        raise Wrong(f"there is no record {path.relative_to(ROOT)}")
    record = json.loads(path.read_text("utf-8"))
    if part:
        return platform_tables.PARTS[part](record)
    return frozen(record) if "hash" in record else searched(record)


def freeze() -> None:
    """Make what the code says now the frozen platforms."""
    for name, platform in PLATFORMS.items():
        now = {"hash": platform.hash, "platform": platform.described()}
        path = RECORDS / f"platform-{name}.json"
        path.write_text(json.dumps(now, indent=1) + "\n", "utf-8")


def searched(results: list[dict]) -> str:
    """Return the counts of a search: a row a setting, a column a cell."""
    cells = list(dict.fromkeys(r["cell"] for r in results))
    keys = list(dict.fromkeys(key for r in results for key in r["point"]))
    rows: dict[str, dict] = {}
    for r in results:
        setting = {"name": r["planner"], **{key: str(r["point"].get(key, MISSING)) for key in keys}}
        row = rows.setdefault(json.dumps(setting), {**setting, **dict.fromkeys(cells, "")})
        row[r["cell"]] = _counts(r)
    columns = {key: itemgetter(key) for key in (*keys, *cells)}
    table = tabled("planner", rows.values(), columns)
    scenes = " or ".join(str(n) for n in sorted({r["scenes"] for r in results}))
    return (
        f"{table}\n\nSuccess / crash / timeout in {scenes} selection scenes; in brackets "
        "the median time of a success, s."
    )


def _counts(result: dict) -> str:
    time = result["median_time_s"]
    counts = f"{result['success']} / {result['crash']} / {result['timeout']}"
    return counts if time is None else f"{counts} ({time:.2f})"


def frozen(record: dict) -> str:
    """Return a frozen platform, a row a part."""
    if "winds" in record["platform"]:
        parts = {name: _flat(value) for name, value in record["platform"].items()}
        return _parts(parts, record["hash"])
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
    return _parts(parts, record["hash"])


def _flat(value: object, within: str = "") -> dict[str, object]:
    if not isinstance(value, dict):
        return {within: value}
    found: dict[str, object] = {}
    for key, each in value.items():
        found |= _flat(each, f"{within}.{key}" if within else key)
    return found


def _parts(parts: dict[str, dict], digest: str) -> str:
    rows = [
        {
            "name": name,
            "settings": ", ".join(f"{key} {value}".strip() for key, value in values.items()),
        }
        for name, values in parts.items()
    ]
    table = tabled("frozen", rows, {"settings": "{settings}"}, words="settings")
    return f"{table}\n\nHash `{digest}`."
