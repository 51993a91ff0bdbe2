"""Figure 1: the interface, and how repair preference reverses when the fault is shared.

The report draws it from the interface and from the decision record of Table IV's question.
"""

from faultpath.studies.page import Page
from faultpath.studies.pages import table_4

REPAIR, BASELINE = table_4.CONTRASTS[0]
"""The contrast that reverses between reconstruction-only and shared corruption."""
CELLS = tuple(table_4.cell(method, path) for path in table_4.PATHS for method in (REPAIR, BASELINE))

PAGE = Page("figure-1", "The information interface, and the reversal it makes", CELLS)
