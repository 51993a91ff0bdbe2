"""Figure 2: the first held-out scene of each topology, drawn by the report."""

from faultpath.studies.page import Page

PAGE = Page("figure-2", "Held-out scenes, the first of each topology")
