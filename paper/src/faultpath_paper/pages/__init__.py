"""The pages of the paper, in the order in which it is read."""

from faultpath_paper.page import Page
from faultpath_paper.pages import (
    figure_3,
    in_text,
    table_1,
    table_2,
    table_3,
    table_4,
    table_5,
    table_6,
)

PAGES: tuple[Page, ...] = (
    table_1.PAGE,
    table_2.PAGE,
    figure_3.PAGE,
    table_3.PAGE,
    table_4.PAGE,
    table_5.PAGE,
    table_6.PAGE,
    in_text.PAGE,
)
