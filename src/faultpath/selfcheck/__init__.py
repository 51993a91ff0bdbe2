"""Simulations that show whether the statistics keep what they promise."""

from faultpath.selfcheck.model import Report, Section
from faultpath.selfcheck.promises import failures
from faultpath.selfcheck.run import PROFILES, check_statistics
from faultpath.selfcheck.words import page, tables

__all__ = [
    "PROFILES",
    "Report",
    "Section",
    "check_statistics",
    "failures",
    "page",
    "tables",
]
