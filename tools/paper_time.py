"""How long the whole paper takes from nothing, and whether it comes out as it is shipped.

    python tools/paper_time.py FOLDER     on a quiet machine; FOLDER is new

Runs `faultpath reproduce --profile paper` into the folder and compares every trial with the shipped
run. Writes `docs/reference/paper-time.json`, of which `docs/reproduction.md` makes a block.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from blocks import REFERENCE, parsed
from command import new_folder
from flown_code import ROOT
from machine import Timed

from faultpath.store import read_outcomes
from faultpath.studies import shipped

RESULT = REFERENCE / "paper-time.json"
OUTCOMES = "outcomes.parquet"


class Flown(Timed):
    """The whole paper, and how it came out."""

    platform: str
    trials: int
    alike: int
    """How many trials the run that was shipped then has, alike to the bit."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure; return the exit status."""
    folder = new_folder(__doc__, arguments)
    asked = ("reproduce", "--profile", "paper", "--out", str(folder))
    timed = Timed.run(ROOT / "src" / "faultpath", *asked)
    platform = shipped.default_platform()
    trials = _trials(folder)
    before = _trials(shipped.RUNS / platform)
    alike = sum(before.get(key) == outcome for key, outcome in trials.items())
    flown = Flown(**timed.model_dump(), platform=platform, trials=len(trials), alike=alike)
    RESULT.write_text(flown.model_dump_json(indent=1) + "\n", "utf-8")
    print(f"Written: {RESULT}")
    return 0


def _trials(folder: Path) -> dict[tuple[object, ...], object]:
    return {
        (row.variant, row.path, row.seed, row.outcome.scene): row.outcome
        for row in read_outcomes(folder / OUTCOMES).rows
    }


def fill() -> str:
    """Return the block of the page."""
    if not RESULT.exists():
        return "*Not timed yet: `python tools/paper_time.py FOLDER` does it.*"
    found = parsed(RESULT, Flown, "run python tools/paper_time.py FOLDER")
    return (
        f"Everything flown from nothing on platform `{found.platform}` in {found.took} "
        f"{found.alike:,} of {found.trials:,} trials came out as in the run that was shipped "
        "before, to the last bit."
    )


if __name__ == "__main__":
    sys.exit(main())
