"""The pages of the paper, in the order in which it is read."""

from faultpath.studies.page import Page
from faultpath.studies.pages import (
    figure_1,
    figure_2,
    figure_3,
    table_1,
    table_2,
    table_3,
    table_4,
    table_5,
    table_6,
)

PAGES: tuple[Page, ...] = tuple(
    module.PAGE
    for module in (
        figure_1,
        figure_2,
        table_1,
        table_2,
        figure_3,
        table_3,
        table_4,
        table_5,
        table_6,
    )
)
