"""Simulations that show whether the statistics keep what they promise."""

from faultpath.selfcheck.model import Report
from faultpath.selfcheck.pages import page
from faultpath.selfcheck.promises import failures
from faultpath.selfcheck.run import PROFILES, check_map, check_statistics

__all__ = [
    "PROFILES",
    "Report",
    "check_map",
    "check_statistics",
    "failures",
    "page",
]
