"""Checks of broken systems, and what failed in them."""

from pathlib import Path

import faultpath

ROOT = Path(__file__).resolve().parents[2]
BROKEN = f"{Path(__file__).with_name('broken.py')}:create"
LOOPS = f"{ROOT / 'tests' / 'toys' / 'line.py'}:create"


def check(name: str = BROKEN, broken: str = "", library: str = "any", **question):
    options = {"broken": broken} if broken else {}
    return faultpath.check(
        name, **{"workers": 0, "library": library, "options": options} | question, progress=False
    )


def failed(report) -> dict[str, tuple[str, ...]]:
    return {check.name: check.failures for check in report.checks if check.status == "failed"}
