"""The toy of the examples, and what most audits of it ask."""

from typing import Any

from cli_runs import ROOT, TOY

FILE = ROOT / "examples" / "toy.py"
VERSIONS = {"baseline": "calibrated", "repair": "blind", "library": "carts"}
AUDIT: dict[str, Any] = {**VERSIONS, "fault": "gain:scale=0.6", "progress": False, "workers": 0}

__all__ = ["AUDIT", "FILE", "ROOT", "TOY", "VERSIONS"]
