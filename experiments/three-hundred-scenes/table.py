"""Print the table of README.md: python experiments/three-hundred-scenes/table.py

Differences of success in percentage points, means over seeds, with the paper's 95 % percentile
bootstrap of scenes. DOB flew once and is paired with each seed.
"""

from pathlib import Path

import numpy as np
import pyarrow.parquet as parquet

HERE = Path(__file__).parent
AUDIT = HERE.parents[1] / "docs" / "reference" / "quadrotor-L3-confirmation"
CONDITIONS = {"correct": "Correct", "reconstruction": "Reconstruction only", "shared": "Shared"}


def success(file):
    """Return success [scenes, seeds] by variant and condition."""
    variants = {}
    for row in parquet.read_table(file).to_pylist():
        where = variants.setdefault((row["variant"], row["condition"]), {})
        where.setdefault(row["scene"], {})[row["seed"]] = row["status"] == "success"
    return {
        at: np.array([[ended[s] for s in sorted(ended)] for _, ended in sorted(scenes.items())])
        for at, scenes in variants.items()
    }


def shown(difference, stream):
    """Return a mean with its interval; bold where it leaves out zero."""
    scenes = 100 * difference.mean(axis=1)
    means = scenes[stream.integers(0, len(scenes), (10_000, len(scenes)))].mean(axis=1)
    low, high = np.percentile(means, [2.5, 97.5])
    text = f"{scenes.mean():+.1f} \\[{low:.1f}, {high:.1f}\\]".replace("-", "−")
    return f"**{text}**" if low > 0 or high < 0 else text


ours = success(AUDIT / "outcomes.parquet")
ours |= {at: one for at, one in success(HERE / "dob.parquet").items() if at[0] == "dob"}
print("| | " + " | ".join(CONDITIONS.values()) + " |\n| :-- |" + " --: |" * len(CONDITIONS))
for name in ("gru", "gru+dcc", "dob"):
    print(
        f"| {name}, % | "
        + " | ".join(f"{100 * ours[name, p].mean():.1f}" for p in CONDITIONS)
        + " |"
    )
for one, two in (("gru+dcc", "gru"), ("dob", "gru"), ("dob", "gru+dcc")):
    stream = np.random.default_rng(0)
    cells = [shown(ours[one, p].astype(float) - ours[two, p], stream) for p in CONDITIONS]
    print(f"| {one} minus {two}, pp | " + " | ".join(cells) + " |")
