"""Figure 2: the first held-out scene of each topology, drawn by the report."""

from faultpath.studies.page import Page

PAGE = Page("figure-2", "Scenes, the first of each topology")
