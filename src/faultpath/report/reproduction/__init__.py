"""A reproduction of the paper: one HTML page, the ledger in the terminal and as Markdown."""

from faultpath.report.reproduction.inputs import ReproductionInput
from faultpath.report.reproduction.page import reproduction_page
from faultpath.report.reproduction.terminal import (
    ledger_counts,
    ledger_markdown,
    ledger_table,
    ledger_view,
)

__all__ = [
    "ReproductionInput",
    "ledger_counts",
    "ledger_markdown",
    "ledger_table",
    "ledger_view",
    "reproduction_page",
]
