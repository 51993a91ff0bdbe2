"""Print the table of README.md: what the points that were tried came to.

python experiments/paper-to-the-letter/table.py
"""

import json
from pathlib import Path

SHOWN = {
    "GRU": "acceleration error, GRU",
    "DOB": "acceleration error, DOB",
    "zero L3": "success, zero, L3",
    "zero L3, free": "success, zero, L3, free",
    "truth L3, free": "success, truth, L3, free",
    "withheld L3": "success, withheld, L3",
    "GRU L0": "success, GRU, L0",
    "GRU L3": "success, GRU, L3",
}
LATER = {"wind_strength": 1.0, "drag_spread": 0.6667, "wind_reach": 1.0}
"""The platform before, by what only later points have."""
RUNGS = {"all": "all", "gru": "reconstruction", "none": "nothing"}

trials = json.loads((Path(__file__).parent / "search.json").read_text())
print(f"| point | fitted | distance | {' | '.join(SHOWN)} | differs from the platform before |")
print("| :-- | :-- | --: |" + " --: |" * len(SHOWN) + " :-- |")
paper = trials[-1]["quantities"]
figures = (f"{paper[name]['target']:.3g}" if name in paper else "–" for name in SHOWN.values())
print(f"| *the paper* | | | {' | '.join(figures)} | |")
before = next(trial["point"] for trial in trials if trial["name"] == "former")
for trial in sorted(trials, key=lambda each: (list(RUNGS).index(each["fitted"]), each["distance"])):
    found = trial["quantities"]
    values = (f"{found[q]['value']:.2f}" if q in found else "–" for q in SHOWN.values())
    point = {"wind_strength": trial["point"]["strength"], **trial["point"]}
    differs = ", ".join(
        f"{key} {value:g}"
        for key, value in point.items()
        if value != before.get(key, LATER.get(key))
        and (key, value) != ("wind_strength", point["strength"])
    )
    row = (trial["name"], RUNGS[trial["fitted"]], f"{trial['distance']:.2f}", *values, differs)
    print(f"| {' | '.join(row)} |")
