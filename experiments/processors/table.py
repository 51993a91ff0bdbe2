"""Print the tables of README.md from the outcomes here and those in docs/reference.

python experiments/processors/table.py   (at the commit that README.md names)
"""

import json
from pathlib import Path

import pyarrow.parquet as parquet

HERE = Path(__file__).parent
SHIPPED = HERE.parents[1] / "docs" / "reference"
RUNS = {
    "toy": ("toy", "toy"),
    "dock": ("dock", "dock"),
    "pendulum": ("pendulum", "pendulum"),
    "learned pendulum": ("learned-pendulum", "learned-pendulum"),
    "main job, seed 0": ("seed-0", "quadrotor-L3"),
    "main job, three seeds": ("three-seeds", "quadrotor-L3-seeds"),
}


def rows(folder):
    """Return the trials of a run by variant, path, scene and seed."""
    found = parquet.read_table(folder / "outcomes.parquet").to_pylist()
    return {(r["variant"], r["path"], r["scene"], r["seed"]): r for r in found}


def number(value):
    """Return a signed number with one decimal."""
    return f"{value:+.1f}".replace("-", "−")


print(
    "| system | trials | rows that differ in any bit | other success |\n| :-- | --: | --: | --: |"
)
for title, (here, there) in RUNS.items():
    mine, theirs = rows(HERE / here), rows(SHIPPED / there)
    unlike = sum(repr(mine[at]) != repr(theirs[at]) for at in mine)
    success = sum(
        (mine[at]["status"] == "success") != (theirs[at]["status"] == "success") for at in mine
    )
    print(f"| {title} | {len(mine):,} | {unlike:,} | {success:,} |")

print("\n| | path | difference, pp | wins and losses | ahead |\n| :-- | :-- | --: | --: | :-- |")
for title in ("main job, seed 0", "main job, three seeds"):
    here, there = RUNS[title]
    for name, folder in (("AMD", SHIPPED / there), ("Intel", HERE / here)):
        record = json.loads((folder / "record.json").read_text("utf-8"))
        asked = record["question"]
        for effect in record["effects"]:
            if effect["path"] not in ("reconstruction", "shared"):
                continue
            found = effect["success"]
            ends = ", ".join(number(found[end]).removeprefix("+") for end in ("low", "high"))
            both = zip(effect["wins"], effect["losses"], strict=True)
            counts = " ".join(f"{won}:{lost}" for won, lost in both)
            ahead = {1: asked["repair"], 0: "not decided", -1: asked["baseline"]}[effect["sign"]]
            value = f"{number(found['value'])} \\[{ends}\\]"
            print(f"| {title}, {name} | {effect['path']} | {value} | {counts} | {ahead} |")
