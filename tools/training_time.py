"""How long it takes to collect all flights and to fit every model of the quadrotor from nothing.

    python tools/training_time.py FOLDER     on a quiet machine; FOLDER is new

Runs `faultpath train quadrotor` into the folder and compares every model with the shipped one.
Writes `docs/reference/training-time.json`, of which `docs/learning-quality.md` makes a block.
"""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from blocks import REFERENCE, parsed, tabled
from command import new_folder
from flown_code import ROOT
from machine import Timed

from faultpath.quadrotor.platform_name import DEFAULT_NAME

RESULT = REFERENCE / "training-time.json"
SHIPPED = ROOT / "src" / "faultpath" / "quadrotor" / "checkpoints" / DEFAULT_NAME.value


class Trained(Timed):
    """What was fitted, in what time."""

    fits: dict[str, float]
    """Seconds of each fit, which has one core, by model and seed."""
    alike: dict[str, bool]
    """Whether the weights are those that are shipped, to the bit."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure; return the exit status."""
    folder = new_folder(__doc__, arguments)
    places = ["--data", str(folder / "data"), "--out", str(folder / "models")]
    timed = Timed.run(ROOT / "src" / "faultpath", "train", "quadrotor", *places)
    cards = {path.stem: _card(path) for path in sorted((folder / "models").glob("*.json"))}
    trained = Trained(
        **timed.model_dump(),
        fits={name: card["duration_s"] for name, card in cards.items()},
        alike={name: _same(name, card) for name, card in cards.items()},
    )
    RESULT.write_text(trained.model_dump_json(indent=1) + "\n", "utf-8")
    print(f"Written: {RESULT}")
    return 0


def _card(path: Path) -> dict[str, Any]:
    return json.loads(path.read_bytes())


def _same(name: str, card: Mapping[str, Any]) -> bool:
    shipped = SHIPPED / f"{name}.json"
    return shipped.is_file() and _card(shipped)["weights_sha256"] == card["weights_sha256"]


def fill() -> str:
    """Return the block of the page."""
    if not RESULT.exists():
        return "*Not measured yet: `python tools/training_time.py FOLDER` does it.*"
    found = parsed(RESULT, Trained, "run python tools/training_time.py FOLDER")
    names = sorted({_model(fit) for fit in found.fits})
    rows = [_row(name, found) for name in names]
    alike = sum(found.alike.values())
    return "\n\n".join(
        [
            f"All flights collected and {len(found.fits)} models fitted from nothing in "
            f"{found.took} {alike} of {len(found.alike)} models have the shipped weights to the "
            "bit.",
            tabled("model", rows, {"fits": "{fits}", "seconds a fit": "{took:0}"}, code=True),
        ]
    )


def _row(name: str, found: Trained) -> dict[str, object]:
    took = [seconds for fit, seconds in found.fits.items() if _model(fit) == name]
    return {"name": name, "fits": str(len(took)), "took": sum(took) / len(took)}


def _model(fit: str) -> str:
    return fit.rpartition("-")[0]


if __name__ == "__main__":
    sys.exit(main())
