"""Print what one map shows on the processor of a kept run and on that of the reference run.

python experiments/processors/maps.py
"""

import json
from pathlib import Path

import pyarrow.parquet as parquet

from faultpath.analyses.map.record import MapRecord

HERE = Path(__file__).parent / "map-quadrotor"
THERE = Path(__file__).parents[2] / "docs" / "reference" / "map-quadrotor"


def trials(folder):
    """Return the trials of a run by variant, errors, scene and seed."""
    rows = parquet.read_table(folder / "outcomes.parquet").to_pylist()
    return {(row["variant"], row["condition"], row["scene"], row["seed"]): row for row in rows}


def read(folder, name):
    """Return what a JSON file of a run holds."""
    return json.loads((folder / name).read_text("utf-8"))


def succeeds(trial):
    """Return whether a trial reached its goal."""
    return trial["status"] == "success"


before, now = trials(HERE), trials(THERE)
both = before.keys() & now.keys()
unlike = sum(before[at] != now[at] for at in both)
other = sum(succeeds(before[at]) != succeeds(now[at]) for at in both)
print("| trials of both | rows that differ in any bit | other success |\n| --: | --: | --: |")
print(f"| {len(both):,} | {unlike:,} | {other:,} |\n")

print("| processor | trials | gru ahead | gru+dcc ahead | neither | headline |")
print("| :-- | --: | --: | --: | --: | :-- |")
signs = []
for folder, flown in ((HERE, before), (THERE, now)):
    record = MapRecord.model_validate(read(folder, "map.json"))
    processor = read(folder, "provenance.json")["machine"]["processor"].replace("(R)", "")
    signs.append({point.errors: point.sign for point in record.points})
    counts = [str(list(signs[-1].values()).count(sign)) for sign in (-1, 1, 0)]
    print("|", " | ".join([processor, f"{len(flown):,}", *counts, record.headline]), "|")

shared = signs[0].keys() & signs[1].keys()
alike = sum(signs[0][at] == signs[1][at] for at in shared)
more = len(signs[1].keys() - shared)
print(f"\nOf {len(shared)} pairs of errors run on both, {alike} come out alike.")
print(f"Pairs of errors run on the second alone: {more}.")
