"""The question of the main job, asked of scenes that nobody has flown before.

    python tools/new_scenes.py FOLDER     make the scenes and fly them; FOLDER is new

The design below was committed before its scenes were made. Ships what it takes to decide anew, in
`docs/reference/new-scenes`, of which `docs/quadrotor.md` makes a block.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from blocks import REFERENCE, TAKE_AGAIN, copied, parsed
from command import faultpath, new_folder
from flown_code import flown_by

from faultpath.record import DecisionRecord, RunProvenance
from faultpath.record.wording import seeds, typeset
from faultpath.report.comparison.page import effects
from faultpath.report.comparison.runs import Compared
from faultpath.report.comparison.words import CAVEAT
from faultpath.store.folder import OUTCOMES
from faultpath.tables.markdown import block

RUNS = REFERENCE / "new-scenes"
DECIDED, FLOWN = "decided.json", "flown.json"
"""Record and provenance by names of their own: without the rest of a run's folder it is none."""
SHIPPED = {OUTCOMES: OUTCOMES, "record.json": DECIDED, "provenance.json": FLOWN}

SEED, SCENES = 404, 300
"""Of the library: three times as many scenes as the main job has, since it left much undecided."""
FAULT = "calibration=0.1,0.2"
"""The error of the main job, and one at which the map of the held-out scenes turns round."""
QUESTION = ("quadrotor", "--baseline", "gru", "--repair", "gru+dcc", "--wind", "L3")


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly; return the exit status."""
    folder = new_folder(__doc__, arguments)
    folder.mkdir(parents=True)
    library, runs = str(folder / "new-scenes.json"), folder / "runs"
    size = ("--seed", str(SEED), "--count", str(SCENES))
    asked = (*QUESTION, "--fault", FAULT, "--library", library, "--out", str(runs))
    faultpath("scenes", "generate", library, *size)
    faultpath("audit", *asked)
    for record in sorted(runs.glob("*/record.json")):
        copied(SHIPPED, record.parent, RUNS / record.parent.name)
    return 0


def folders() -> list[Path]:
    """Return the folder of each size that was flown."""
    return sorted(path.parent for path in RUNS.glob(f"*/{DECIDED}"))


def fill() -> str:
    """Return the block of the page."""
    runs = [_read(number, folder) for number, folder in enumerate(folders(), 1)]
    if not runs:
        return "*Not flown yet: `python tools/new_scenes.py FOLDER` does it.*"
    first = runs[0]
    headlines = "\n".join(
        f"> - `{run.asked.fault}`: **{typeset(run.record.verdict.headline)}**" for run in runs
    )
    by_code = {run.provenance.system_fingerprint: run for run in reversed(runs)}
    flown = [flown_by(r.provenance, r.asked.system, r.asked.options) for r in by_code.values()]
    return "\n\n".join(
        [
            headlines,
            block(effects(runs)),
            f"{first.asked.n_scenes} scenes, {seeds(first.asked.seeds)}. Intervals are for "
            f"{first.record.estimand}. {CAVEAT} {' '.join(flown)}",
        ]
    )


def _read(number: int, folder: Path) -> Compared:
    record = parsed(folder / DECIDED, DecisionRecord, TAKE_AGAIN)
    made = parsed(folder / FLOWN, RunProvenance, TAKE_AGAIN)
    return Compared(number, folder.name, record, made)


if __name__ == "__main__":
    sys.exit(main())
