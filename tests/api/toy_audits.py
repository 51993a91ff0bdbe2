"""The toy of the examples, and what most audits of it ask."""

import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "examples" / "toy.py"
TOY = f"{FILE}:create"
VERSIONS = {"baseline": "calibrated", "repair": "blind", "library": "carts"}
AUDIT: dict[str, Any] = {**VERSIONS, "fault": "gain:scale=0.6", "progress": False, "workers": 0}

sys.path.append(str(ROOT / "tests" / "cli"))
from cli_runs import faultpath as command  # noqa: E402, F401 - the command line, in this process
