"""The pages of the paper, in the order in which it is read."""

from faultpath.studies.page import Page
from faultpath.studies.pages import (
    detection,
    differences_still,
    differences_wind,
    figure_3,
    table_1,
    table_2,
    table_3,
    table_4,
    table_5,
    table_6,
    text_calibration,
    text_mechanism,
    text_planning,
    text_wind,
)

FIGURE_1 = Page(
    "figure-1",
    "The information interface, and the reversal it makes",
    drawn=tuple(
        table_4.cell(method, path) for path in table_4.PATHS for method in ("gru+dcc", "gru")
    ),
)
FIGURE_2 = Page("figure-2", "Scenes, the first of each topology")

PAGES: tuple[Page, ...] = (
    FIGURE_1,
    FIGURE_2,
    table_1.PAGE,
    table_2.PAGE,
    figure_3.PAGE,
    text_calibration.PAGE,
    table_3.PAGE,
    table_4.PAGE,
    table_5.PAGE,
    text_wind.PAGE,
    table_6.PAGE,
    text_mechanism.PAGE,
    text_planning.PAGE,
    detection.PAGE,
    differences_still.PAGE,
    differences_wind.PAGE,
)
